/* SPDX-License-Identifier: Apache-2.0 */
/* Trouser tears of elastic yarns: floats hold less, so more wefts slide together at the point of the tear and share
 * its load. Satin takes more than twill, twill more than plain weave, 1.4 to 4 yarns' strength (2 to 6 were asked). */
#include "tests/lib/test.h"

#include "tests/lib/world_fixture.h"

enum { TICKS = 900, DRAWN = 250 };
#define STRENGTH_N (0.5 * 0.06) /* of a yarn, mean */

static void open_trousers(fixture *f, const char *weave, uint32_t substeps) {
  fixture_print(f,
                "scene trousers\nrate 1000 Hz\nsubsteps %u\ngravity 0 0 0 cm/s2\nseed 1\n"
                "limits {\n splits_per_tick 512\n}\n"
                "woven {\n warps 32\n wefts 40\n spacing 12 /cm\n weave %s\n tear 5 7 %%\n yarns on\n"
                " stretch 0.5 N\n slip_friction 0.3\n crossing_friction 3 mN\n drag 2 /s\n}\n"
                "slit warp 15 0 12\npin block 0 14 0 0 by left\npin block 17 31 0 0 by right\n"
                "capsule left {\n radius 0.05 cm\n length 1 cm\n at -0.66 1.625 0.4 cm\n move path {"
                " 0 s -0.66 1.625 0.4 cm 0.5 s -0.66 -1 2.5 cm 0.9 s -0.66 -1 6.5 cm }\n}\n"
                "capsule right {\n radius 0.05 cm\n length 1 cm\n at 0.66 1.625 -0.4 cm\n move path {"
                " 0 s 0.66 1.625 -0.4 cm 0.5 s 0.66 -1 -2.5 cm 0.9 s 0.66 -1 -6.5 cm }\n}\n",
                substeps, weave);
}

/* Newtons on a leg, the mean of both. */
static double force_on_legs(const fixture *f) {
  double sum = 0;
  for (uint32_t b = 0; b < 2; ++b) {
    const fray_body leg = fray_view_body(f->w, b);
    const double unit = fixture_speed(f) * fixture_mass_g(f) * f->facts.rate_hz * 1e-5;
    double square = 0;
    for (uint32_t axis = 0; axis < 3; ++axis) square += (double)leg.impulse[axis] * (double)leg.impulse[axis];
    sum += sqrt(square) * unit / 2;
  }
  return sum;
}

/* Mean of the largest force before each break, in yarns' strengths. */
static double mean_peak(const char *name, const char *weave, uint32_t substeps) {
  fixture_scoped f = {0};
  double most = 0;
  double sum = 0;
  uint32_t breaks = 0;
  uint32_t tears = 0;
  open_trousers(&f, weave, substeps);
  for (uint32_t tick = 0; tick < TICKS; ++tick) {
    const fray_output out = fixture_tick(&f, &fixture_idle);
    if (tick >= DRAWN) most = fmax(most, force_on_legs(&f));
    if (tick >= DRAWN && out.tears_total > tears) {
      sum += most;
      most = 0;
      ++breaks;
    }
    tears = out.tears_total;
  }
  CHECK(breaks > 3);
  const double peak = sum / (breaks > 0 ? breaks : 1) / STRENGTH_N;
  char text[64];
  snprintf(text, sizeof text, "trouser_%s_%u_substeps", name, substeps);
  figure(text, peak, "yarns", "plain below twill below satin; 2 to 6");
  return peak;
}

static void floats_share_the_load(void) {
  const double plain = mean_peak("plain", "plain", 8);
  const double satin = mean_peak("satin", "satin 8", 8);
  CHECK(plain > 1.2 && plain < 3 && satin > 1.8 * plain && satin < 6.5);
  if (TEST_FEWER > 1) return;
  const double twill = mean_peak("twill", "twill 2/1", 8);
  CHECK(twill > 1.1 * plain && twill < satin);
}

/* Printed: at 4 substeps plain weave is off. */
static void over_substeps(void) {
  for (uint32_t substeps = 4; substeps <= 16; substeps *= 4) {
    (void)mean_peak("plain", "plain", substeps);
    (void)mean_peak("twill", "twill 2/1", substeps);
    (void)mean_peak("satin", "satin 8", substeps);
  }
}

/* `test_yarn_trouser all`: at 4 and 16 substeps, too. */
int main(int argc, char **argv) {
  TEST(floats_share_the_load);
  if (argc > 1 && strcmp(argv[1], "all") == 0) TEST(over_substeps);
  return test_end();
}
