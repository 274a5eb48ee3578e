/* SPDX-License-Identifier: Apache-2.0 */
/* A warp is drawn out of wefts that are held on both sides of it: what it takes grows with the crossings, and
 * is over when the yarn's end has passed the last of them. */
#include "tests/lib/test.h"

#include "rt/state/crossing.h"
#include "tests/lib/world_fixture.h"
#include "tests/lib/yarn_check.h"

enum { CHECKED_EVERY = 64 };

typedef struct {
  double peak;       /* mN a crossing, mean of ten ticks */
  double free_after; /* spacings that the grip has moved when the last crossing lets go */
  double made;       /* by slip, less what it lost, of the work of the hand; of a watched cloth */
} pull;

/* The middle warp is drawn by its lowest particle, and the weft there with it. */
static void open_pulled(fixture *f, uint32_t crossings, uint32_t substeps, double friction, const char *stretch,
                        double way, double seconds) {
  const uint32_t wefts = crossings + 1;
  const double half = (wefts - 1) / 24.0;
  const char *tear = stretch[0] != 0 ? "19 19 %\n split_strain 18 18 %" : "300 300 %\n split_strain 200 200 %";
  fixture_print(f,
                "scene pull\nrate 1000 Hz\nsubsteps %u\ngravity 0 0 0 cm/s2\nseed 9\n"
                "woven {\n warps 3\n wefts %u\n spacing 12 /cm\n tear %s\n yarns all\n slip_friction %.2f\n"
                " crossing_friction 0.3 mN\n drag 4 /s\n%s}\n"
                "pin block 0 0 0 %u\npin block 2 2 0 %u\n"
                "sphere grip {\n radius 0.04 cm\n at 0 %.6f 0 cm\n attach_within 0.01 cm\n"
                " move path { 0 s 0 %.6f 0 cm  %.4f s 0 %.6f 0 cm }\n}\n",
                substeps, wefts, tear, friction, stretch, wefts - 2, wefts - 2, -half, -half, seconds,
                -half - way);
  for (uint32_t c = 0; c < f->w->capacity[POOL_CROSSINGS]; ++c)
    if (crossing_state_at(f->w, c) == FRAY_CONNECTED) crossing_set_state(f->w, c, FRAY_LOOSE);
}

static void open_cloth(fixture *f, uint32_t crossings, uint32_t substeps, double friction, const char *stretch) {
  const double way = (crossings + 3) / 12.0;
  open_pulled(f, crossings, substeps, friction, stretch, way, way / 2);
}

static double force_on(const fixture *f, uint32_t b) {
  const double speed = (double)fray_view_body(f->w, b).impulse[1] * fixture_speed(f);
  return fabs(speed * fixture_mass_g(f) * f->facts.rate_hz * 1e-2);
}

static double made_by_slip(const fray_world *w) {
  const fray_energy_account a = fray_energy(w);
  return (double)(a.made[FRAY_ENERGY_SLIP] - a.lost[FRAY_ENERGY_SLIP]) / (double)a.supplied[FRAY_SUPPLIED_BODIES];
}

static pull draw(uint32_t crossings, uint32_t substeps, double friction, const char *stretch, int watched) {
  fixture_scoped f = {0};
  CLOSED_BY(yarn_check_close) yarn_check k = {0};
  pull p = {0, 0, 0};
  double smoothed = 0;
  uint32_t grip = 0;
  open_cloth(&f, crossings, substeps, friction, stretch);
  yarn_check_open(&k, &f);
  if (watched) fray_energy_watch(f.w);
  while (fray_view_body(f.w, grip).motion != FRAY_PATH) ++grip;
  const int32_t begun = fray_view_body(f.w, grip).position[1];
  const double spacing = f.w->woven.link_classes[CLASS_WARP].rest;
  for (uint32_t tick = 0; tick < (crossings + 3) * 500 / 12; ++tick) {
    const fray_output out = fixture_tick(&f, &fixture_idle);
    const double moved = (begun - fray_view_body(f.w, grip).position[1]) / spacing;
    if (tick % CHECKED_EVERY == 0) yarn_check_tick(&k, &f);
    smoothed += (force_on(&f, grip) - smoothed) / 10;
    if (moved > 0.5) p.peak = fmax(p.peak, smoothed / crossings);
    if (out.crossings_loose != 0) p.free_after = moved;
  }
  p.made = watched ? made_by_slip(f.w) : 0;
  CHECK_EQ_INT(k.bad, 0);
  CHECK(p.free_after > crossings - 1.1 && p.free_after < crossings + 1);
  return p;
}

static void print_pull(const char *what, uint32_t number, const pull *p) {
  char name[64];
  snprintf(name, sizeof name, "pull_out_%s_%u", what, number);
  figure(name, p->peak, "mN_a_crossing", "0.3 and mu N");
  snprintf(name, sizeof name, "pull_out_%s_%u_free_after", what, number);
  figure(name, p->free_after, "spacings", "its crossings, within 1.1");
}

/* As large a part of the largest as the smallest is. */
static double compare(const char *what, const uint32_t *numbers, uint32_t count, int are_crossings,
                      const char *stretch) {
  double least = 1e9;
  double most = 0;
  for (uint32_t n = 0; n < count; ++n) {
    const pull p = are_crossings ? draw(numbers[n], 16, 0.1, stretch, 0) : draw(23, numbers[n], 0.1, stretch, 0);
    print_pull(what, numbers[n], &p);
    least = fmin(least, p.peak);
    most = fmax(most, p.peak);
  }
  return least / most;
}

static void the_peak_grows_with_the_crossings(void) {
  static const uint32_t crossings[] = {11, 23, 47};
  CHECK(compare("projected", crossings, 3, 1, "") > 0.9);
  CHECK(compare("stretch", crossings, 3, 1, " stretch 0.5 N\n") > 0.9);
}

/* At 4 substeps a projected yarn gives way before it is drawn out: see rt/woven/README.md. */
static void the_peak_does_not_depend_on_substeps(void) {
  static const uint32_t projected[] = {12, 16, 24};
  static const uint32_t stretched[] = {4, 8, 16};
  CHECK(compare("projected_substeps", projected, 3, 0, "") > 0.93);
  CHECK(compare("stretch_substeps", stretched, 3, 0, " stretch 0.5 N\n") > 0.995);
}

/* What the yarns' own grip holds: 22 crossings at 0.3 mN, the topmost of them at the end of its yarn. */
static void friction_alone_holds_its_limit(void) {
  const pull p = draw(23, 16, 0, "", 0);
  figure("pull_out_without_mu", 23 * p.peak, "mN", "6.6 within 5 %");
  CHECK(fabs(23 * p.peak / 6.6 - 1) < 0.05);
}

/* A hand that stops is pulled by what friction holds for as long as it stands, at a tenth of the speed as well. */
static void a_hand_that_stops_is_held(const char *name, const char *stretch) {
  fixture_scoped f = {0};
  double at_100_ms = 0;
  double force = 0;
  uint32_t grip = 0;
  open_pulled(&f, 11, 8, 0.1, stretch, 0.5 / 12, 0.05);
  while (fray_view_body(f.w, grip).motion != FRAY_PATH) ++grip;
  for (uint32_t tick = 0; tick < 1000; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    force += (force_on(&f, grip) - force) / 10;
    if (tick == 150) at_100_ms = force;
  }
  char text[64];
  snprintf(text, sizeof text, "pull_out_held_%s", name);
  figure(text, force, "mN", "3.3 within 10 %");
  CHECK(fabs(force / 3.3 - 1) < 0.1 && fabs(force / at_100_ms - 1) < 0.01);
}

static void what_is_held_stays_held(void) {
  a_hand_that_stops_is_held("projected", "");
  a_hand_that_stops_is_held("stretch", " stretch 0.5 N\n");
}

static void friction_takes_the_work(void) {
  const pull projected = draw(11, 16, 0.1, "", 1);
  const pull stretched = draw(11, 4, 0.1, " stretch 0.5 N\n", 1);
  figure("pull_out_made_by_slip", projected.made, "of the work", "below 0");
  figure("pull_out_made_by_slip_stretch", stretched.made, "of the work", "-0.8 to -1.05");
  CHECK(projected.made < 0);
  CHECK(stretched.made > -1.05 && stretched.made < -0.8);
}

int main(void) {
  TEST(the_peak_grows_with_the_crossings);
  TEST(the_peak_does_not_depend_on_substeps);
  TEST(friction_alone_holds_its_limit);
  TEST(what_is_held_stays_held);
  TEST(friction_takes_the_work);
  return test_end();
}
