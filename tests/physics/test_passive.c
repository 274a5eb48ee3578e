/* SPDX-License-Identifier: Apache-2.0 */
/* Two handles in the hands of 20 simulated arms: what the world gives to both, and what is made in
 * any window, where what the world stores counts as there (of the tick whose force the arm has
 * held: it comes `delay` ticks later). `test_passive all` takes every arm for a minute. */
#include "tests/lib/held_cloth.h"
#include "tests/lib/test.h"

static uint32_t seconds = 1;
static uint32_t every = 4 * TEST_FEWER;

static const double masses[] = {0.1, 0.3, 1, 2};           /* kg */
static const double springs[] = {0, 200, 500, 1000, 2000}; /* N/m */
enum { MASSES = 4, ARMS = 20 };

typedef struct {
  double out_uj;    /* the most that both arms have got over what they gave */
  double window_uj; /* the most that was made */
  double meter_uj;  /* by how much the world's own meters were off */
  double taken_uj;  /* by the controller */
  double step_n_ms; /* the largest change of a force in a tick */
} arm_run;

static void keep_worst(arm_run *worst, const arm_run *r) {
  worst->out_uj = fmax(worst->out_uj, r->out_uj);
  worst->window_uj = fmax(worst->window_uj, r->window_uj);
  worst->meter_uj = fmax(worst->meter_uj, r->meter_uj);
  worst->taken_uj = fmax(worst->taken_uj, r->taken_uj);
  worst->step_n_ms = fmax(worst->step_n_ms, r->step_n_ms);
}

/* An arm rests, jumps, draws. */
static void find_goals(uint64_t *random, uint32_t tick, uint32_t rate, double goals[FRAY_HANDS][3]) {
  const uint32_t phase = 7 * rate / 10;
  if (tick % phase != 0) return;
  for (uint32_t n = 0; n < 3 * FRAY_HANDS; ++n) {
    const double share = (double)(splitmix64(random) >> 11) * 0x1p-53 - 0.5;
    goals[n / 3][n % 3] = tick / phase % 3 == 2 ? 0 : 0.02 * share;
  }
}

/* J, since the account began. */
static double stored_in(const fixture *f) {
  const fray_energy_account a = fray_energy(f->w);
  const double speed = (double)f->facts.lu_um * f->facts.rate_hz * f->facts.substeps;
  double sum = -(double)a.begun;
  for (uint32_t n = 0; n < FRAY_ENERGY_STORES; ++n) sum += (double)a.stored[n];
  return a.ticks == 0 ? 0 : sum * 0x1p-40 * f->facts.particle_mass_ng * 1e-24 * speed * speed;
}

static double meter_of(const fixture *f, double *taken) {
  double given = 0;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    fray_handle handle;
    CHECK(fray_view_handle(f->w, h, &handle) == 1);
    given += (double)handle.given_nj * 1e-9;
    *taken = fmax(*taken, (double)handle.taken_nj * 1e-3);
  }
  return given;
}

static arm_run run_arms(fixture *f, double mass, double spring, uint32_t delay) {
  arm_run r = {0, 0, 0, 0, 0};
  arm arms[FRAY_HANDS] = {arm_make(mass, spring, delay), arm_make(mass, spring, delay)};
  uint64_t random = 12345;
  double goals[FRAY_HANDS][3] = {{0}};
  int16_t poses[FRAY_HANDS][3] = {{0}};
  int16_t before[FRAY_HANDS][3] = {{0}};
  double stored[ARM_DELAY_MAX] = {0};
  double top = 0;
  double given = 0;
  (void)fixture_start_hands(f, 300 * f->facts.rate_hz / 1000);
  fray_energy_watch(f->w);
  for (uint32_t tick = 0; tick < f->facts.rate_hz * seconds; ++tick) {
    find_goals(&random, tick, f->facts.rate_hz, goals);
    const fray_output out = held_cloth_tick(f, arms, poses, (const double(*)[3])goals, tick);
    r.meter_uj = fmax(r.meter_uj, fabs(given + meter_of(f, &r.taken_uj)) * 1e6);
    given = arms[0].given + arms[1].given;
    memmove(stored + 1, stored, sizeof stored - sizeof stored[0]);
    stored[0] = stored_in(f);
    const double lost = given - stored[delay - 1];
    top = fmax(top, lost);
    r.window_uj = fmax(r.window_uj, 1e6 * (top - lost));
    r.out_uj = fmax(r.out_uj, -1e6 * given);
    for (uint32_t n = 0; n < 3 * FRAY_HANDS; ++n) {
      r.step_n_ms = fmax(r.step_n_ms, abs(out.force[n / 3][n % 3] - before[n / 3][n % 3]) * 0.5e-6 * f->facts.rate_hz);
      before[n / 3][n % 3] = out.force[n / 3][n % 3];
    }
  }
  return r;
}

static arm_run worst_of(uint32_t rate, uint32_t coupling, uint32_t delay) {
  arm_run worst = {0, 0, 0, 0, 0};
  char hands[64];
  snprintf(hands, sizeof hands, " energy_reserve 2 J\n delay %u\n", delay);
  for (uint32_t n = delay % every; n < ARMS; n += every) {
    fixture_scoped f = {0};
    held_cloth_open_at(&f, rate, coupling, "", hands, "");
    const arm_run r = run_arms(&f, masses[n % MASSES], springs[n / MASSES], delay);
    keep_worst(&worst, &r);
  }
  printf(
      "figure %u Hz, coupling of %u N/m, delay %u: out %.3g uJ, any window %.3g uJ, meters off %.3g uJ, "
      "controller %.3g uJ, step %.3g N/ms\n",
      rate, coupling, delay, worst.out_uj, worst.window_uj, worst.meter_uj, worst.taken_uj,
      worst.step_n_ms);
  return worst;
}

/* Without the controller. Out: what a step of a pose at a few steps of force is worth. The window
 * is of both hands, 20 uJ each. */
static void the_coupling_gives_nothing(void) {
  for (uint32_t coupling = 1000; coupling <= 2000; coupling += 1000)
    for (uint32_t delay = 1; delay <= 3; ++delay) {
      const arm_run r = worst_of(1000, coupling, delay);
      CHECK(r.out_uj <= 0.1);
      CHECK(r.window_uj <= 40);
      CHECK(r.taken_uj == 0);
      CHECK(r.meter_uj <= 60);
      CHECK(r.step_n_ms <= 0.8);
    }
}

/* The window falls short of the 40 uJ above, as rt/haptics/README.md says: a force is held for a tick, and the arm
 * goes on in it. It is held to what was measured and a third more. */
static void at_lower_rates(void) {
  for (uint32_t rate = 250; rate <= 500; rate += 250)
    for (uint32_t coupling = 1000; coupling <= 2000; coupling += 1000)
      for (uint32_t delay = 1; delay <= 3; ++delay) {
        const arm_run r = worst_of(rate, coupling, delay);
        CHECK(r.out_uj <= 0.1);
        CHECK(r.window_uj <= (rate == 500 ? 500 : 2900));
        CHECK(r.taken_uj == 0);
        CHECK(r.step_n_ms <= 0.8);
      }
}

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "all") == 0) {
    seconds = 60;
    every = 1;
  }
  TEST(the_coupling_gives_nothing);
  TEST(at_lower_rates);
  return test_end();
}
