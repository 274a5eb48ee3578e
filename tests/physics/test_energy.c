/* SPDX-License-Identifier: Apache-2.0 */
/* Mechanical energy of the hanging sheet, without drag, and the paper's own mode of solving. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

/* Kinetic, potential, bend and shear energy of the free particles. The structural springs hold
 * energy too, and it is not counted: they start at rest length, so what they give back they took
 * before. Nothing else puts energy in, and projection takes it out, so it must never exceed its
 * start: the bound is 0. It can rise from a low, while stretched springs give back; that is only
 * printed. */
typedef struct {
  double most; /* above the start */
  double rise; /* above the least so far */
  double end;  /* minus the start */
} energy_run;

static energy_run follow(fixture *f, uint32_t ticks, double *strain) {
  const double start = fixture_energy(f, 5, 2);
  energy_run e = {-1e300, 0, 0};
  double low = start;
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    (void)fixture_tick(f, &fixture_idle);
    const double now = fixture_energy(f, 5, 2);
    e.most = fmax(e.most, now - start);
    low = fmin(low, now);
    e.rise = fmax(e.rise, now - low);
    e.end = now - start;
    if (strain != NULL) *strain = fmax(*strain, fixture_largest_strain(f->w, NULL));
  }
  return e;
}

static void judge(const char *label, energy_run e) {
  char name[64];
  snprintf(name, sizeof name, "energy_%s_above_start", label);
  figure(name, e.most, "erg", "at most 0");
  snprintf(name, sizeof name, "energy_%s_rise_from_a_low", label);
  figure(name, e.rise, "erg", "printed");
  snprintf(name, sizeof name, "energy_%s_at_the_end", label);
  figure(name, e.end, "erg", "below 0");
  CHECK(e.most <= 0);
  CHECK(e.end < 0);
}

static void a_hanging_sheet_gains_no_energy(void) {
  static const uint32_t substeps[] = {2, 4, 6, 16};
  for (uint32_t n = 0; n < 4; ++n) {
    fixture_scoped f = {0};
    char label[32];
    fixture_hanging(&f, 40, 40, substeps[n], "0 s", "5 %", "0 /s");
    snprintf(label, sizeof label, "hanging_%u_substeps", substeps[n]);
    judge(label, follow(&f, 2000, NULL));
  }
}

#define PAPER "rate 1000 Hz", "rate 240 Hz", "substeps auto", "substeps 1", "iterations 1", "iterations 40"

/* The setting of Metaaphanon 2009: 240 Hz, no substeps, 40 sweeps, hands that hold two corners.
 * First for two seconds from the gathered start, without tearing and drag. */
static void the_papers_mode_gains_no_energy(void) {
  fixture_scoped f = {0};
  double strain = 0;
  fixture_file(&f, "tests/scenes/two_hands.scene", PAPER, "tear 5 10 %", "tear off", "drag 2 /s",
               "drag 0 /s", "settle 1 s", "settle 0 s", "plane ground {\n  at 0 -4.5",
               "plane ground {\n  at 0 -50", NULL);
  judge("paper_mode", follow(&f, 480, NULL));
  fixture_close(&f);
  fixture_file(&f, "tests/scenes/two_hands.scene", PAPER, "tear 5 10 %", "tear off", NULL);
  (void)follow(&f, 240, &strain);
  figure("paper_mode_strain_at_rest", 100 * strain, "%", "printed: far more than with substeps");
  CHECK(strain > 0.05);
}

/* It runs, and it tears: at rest already, since the strain there is over every threshold. */
static void the_papers_mode_runs_and_tears(void) {
  fixture_scoped f = {0};
  fixture_file(&f, "tests/scenes/two_hands.scene", PAPER, NULL);
  fray_output out = fixture_start_hands(&f, 48);
  figure("paper_mode_cuts_at_rest", out.tears_total, "in_0.2_s", "printed");
  for (uint32_t tick = 0; tick < 720; ++tick) {
    const int32_t at = (int32_t)tick * 20; /* 9.6 mm/s each, 29 mm in 3 s */
    const int32_t to[FRAY_HANDS][3] = {{-at, 0, 0}, {at, 0, 0}};
    const fray_input input = fixture_poses(&f, to, tick);
    out = fixture_tick(&f, &input);
  }
  figure("paper_mode_cuts_pulled", out.tears_total, "in_3.2_s", "more than 0");
  CHECK(out.tears_total > 0);
  CHECK_EQ_INT(out.state, FRAY_OPERATIONAL);
  CHECK((out.faults & FRAY_FAULT_OUT_OF_WORLD) == 0);
}

int main(void) {
  TEST(a_hanging_sheet_gains_no_energy);
  TEST(the_papers_mode_gains_no_energy);
  TEST(the_papers_mode_runs_and_tears);
  return test_end();
}
