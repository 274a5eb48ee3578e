/* SPDX-License-Identifier: Apache-2.0 */
/* Pools that are too small: every run finishes, what does not fit is reported, the caps hold. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

enum { TICKS = 300 };

static void open_ball(fixture *f, const char *limits) {
  fixture_print(f,
                "scene ball\nrate 1000 Hz\nsubsteps 6\niterations 1\nseed 3\n"
                "limits {\n %s\n}\n"
                "woven {\n warps 24\n wefts 16\n spacing 12 /cm\n tear 5 10 %%\n}\n"
                "pin column left\npin column right\n"
                "sphere b {\n radius 0.3 cm\n at 0.1 0.1 1 cm\n move free\n mass 20 g\n"
                " velocity 0 20 -200 cm/s\n}\nplane ground {\n at 0 -3 0 cm\n}\n",
                limits);
}

static void contacts_are_capped_and_reported(void) {
  static const double shares[] = {0, 0, 0, 0, 0.25, 0.5, 0.9};
  fixture f;
  uint32_t needed = 0;
  uint64_t free_hash = 0;
  open_ball(&f, "contacts 2000");
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    const fray_output out = fixture_tick(&f, &fixture_idle);
    if (f.w->contact.count > needed) needed = f.w->contact.count;
    CHECK((out.faults & FRAY_FAULT_CONTACTS_FULL) == 0);
    free_hash = out.hash;
  }
  fixture_close(&f);
  figure("contacts_needed", needed, "", "printed");
  CHECK(needed > 20);
  for (uint32_t n = 0; n < 9; ++n) {
    const uint32_t small[] = {0, 1, 2, 5};
    uint32_t capacity = n < 4 ? small[n] : needed - (n == 7);
    if (n >= 4 && n < 7) capacity = (uint32_t)(shares[n] * needed);
    char limits[64];
    snprintf(limits, sizeof limits, "contacts %u", capacity);
    open_ball(&f, limits);
    CHECK_EQ_INT(f.facts.contacts_max, capacity);
    fray_output out;
    memset(&out, 0, sizeof out);
    for (uint32_t tick = 0; tick < TICKS; ++tick) {
      out = fixture_tick(&f, &fixture_idle);
      CHECK(f.w->contact.count <= capacity);
      CHECK(out.work.contacts <= fray_work_bound(f.w).contacts);
    }
    CHECK_EQ_INT(out.tick, TICKS - 1);
    CHECK_EQ_INT((out.faults & FRAY_FAULT_CONTACTS_FULL) != 0, capacity < needed);
    /* a pool that is just large enough changes nothing */
    if (capacity == needed) CHECK(out.hash == free_hash);
    fixture_close(&f);
  }
}

/* All yarns come apart at every crossing and lie on the ground: two particles where there was one. */
static void a_default_is_enough_for_every_particle(void) {
  fixture_scoped f = {0};
  uint32_t faults = 0;
  uint32_t most = 0;
  int64_t lowest = INT64_MAX;
  fixture_print(&f, "scene heap\nrate 1000 Hz\nsubsteps 6\nwoven {\n warps 10\n wefts 10\n spacing 12 /cm\n yarns all\n"
                    " disconnect_by particles\n orientation horizontal\n tear off\n at 0 0.5 0 mm\n}\n"
                    "plane ground {\n at 0 0 0 cm\n}\n");
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    faults |= fixture_tick(&f, &fixture_idle).faults;
    if (f.w->contact.count > most) most = f.w->contact.count;
    for (uint32_t p = 0; p < f.w->p.count; ++p)
      if (f.w->p.y[p] < lowest) lowest = f.w->p.y[p];
  }
  figure("heap_contacts", most, "", "200: every particle");
  figure("heap_lowest", (double)lowest / FX_LU, "lu", "at least 0");
  CHECK_EQ_INT(most, 200);
  CHECK_EQ_INT(faults & FRAY_FAULT_CONTACTS_FULL, 0);
  CHECK(lowest >= 0);
}

/* Never more cuts in a tick than the cap; what is over it waits and says so. */
static void cuts_are_capped_and_wait(void) {
  for (uint32_t cap = 1; cap <= 64; ++cap) {
    fixture_scoped f = {0};
    char limits[64];
    uint32_t before = 0;
    uint32_t most = 0;
    uint32_t waited = 0;
    snprintf(limits, sizeof limits, "tears_per_tick %u", cap);
    open_ball(&f, limits);
    fray_output out;
    memset(&out, 0, sizeof out);
    for (uint32_t tick = 0; tick < TICKS; ++tick) {
      out = fixture_tick(&f, &fixture_idle);
      const uint32_t cut_now = out.tears_total - before;
      before = out.tears_total;
      if (cut_now > most) most = cut_now;
      CHECK(cut_now <= cap);
      CHECK_EQ_INT(cut_now, out.work.tears);
      if (out.tears_waiting > 0) {
        ++waited;
        CHECK_EQ_INT(cut_now, cap);
      }
      CHECK_EQ_INT((out.faults & FRAY_FAULT_BREAK_BUDGET) != 0, waited > 0);
    }
    if (cap == 1 || cap == 4 || cap == 16 || cap == 64) {
      char name[64];
      char asked[64];
      snprintf(name, sizeof name, "cuts_in_a_tick_cap_%u", cap);
      snprintf(asked, sizeof asked, "at most %u; %u cuts, %u ticks waited", cap, before, waited);
      figure(name, most, "", asked);
    }
    if (cap == 1) CHECK(waited > 0);
    CHECK(before > 0);
  }
}

int main(void) {
  TEST(a_default_is_enough_for_every_particle);
  TEST(contacts_are_capped_and_reported);
  TEST(cuts_are_capped_and_wait);
  return test_end();
}
