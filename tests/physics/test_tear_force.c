/* SPDX-License-Identifier: Apache-2.0 */
/* How the force at the first tear depends on the number of substeps.
 *
 * Plain projection has no stiffness of its own: a chain of links is as stiff as the solver is
 * (one sweep of h = T / n per link), so the tension at a given strain grows with the square of the
 * substeps. The force that a hand feels when the cloth tears is therefore no material constant;
 * this test pins how far from one it is. A smaller sheet of the same structure as two_hands: held
 * at its upper corners by two balls that the hands move apart, slowly. */
#include "tests/lib/test.h"
#include "tests/lib/world_fixture.h"

static const uint32_t substeps_tried[] = {4, 6, 8, 12, 16, 24, 32};
enum { TRIED = sizeof substeps_tried / sizeof substeps_tried[0], MEAN = 10 };

typedef struct {
  double peak_mN;  /* of the two hands' mean pull along x in the tick of the first cut */
  double mean_mN;  /* over the ticks up to it */
  double strain;   /* of the width between the hands */
  uint32_t tick;
} first_tear;

static first_tear pull_apart(uint32_t substeps) {
  fixture_scoped f = {0};
  first_tear t = {0, 0, 0, 0};
  double recent[MEAN] = {0};
  fixture_print(&f,
                "scene pulled\nrate 1000 Hz\nsubsteps %u\niterations 1\nsettle 1 s\nseed 20091\n"
                "woven {\n warps 24\n wefts 12\n spacing 12 /cm\n bend 5 g/s2\n shear 2 g/s2\n"
                " tear 5 10 %%\n drag 2 /s\n}\n"
                "sphere left {\n radius 0.25 cm\n at -0.9583 0.4583 0 cm\n move hand left\n"
                " attach_within 0.02 cm\n}\n"
                "sphere right {\n radius 0.25 cm\n at 0.9583 0.4583 0 cm\n move hand right\n"
                " attach_within 0.02 cm\n}\n",
                substeps);
  (void)fixture_start_hands(&f, 200);
  const double left = f.w->rigid.states[0].position[0];
  const double right = f.w->rigid.states[1].position[0];
  for (uint32_t tick = 0; tick < 4000; ++tick) {
    const int32_t at = (int32_t)tick * 5 / 2; /* 5 mm/s each */
    const int32_t to[FRAY_HANDS][3] = {{-at, 0, 0}, {at, 0, 0}};
    const fray_input input = fixture_poses(&f, to, tick);
    const fray_output out = fixture_tick(&f, &input);
    const double pull = 0.5 * 0.5 * (out.force_unlimited[0][0] - out.force_unlimited[1][0]);
    recent[tick % MEAN] = pull;
    if (out.tears_total == 0) continue;
    t.tick = tick;
    t.peak_mN = pull;
    for (uint32_t n = 0; n < MEAN; ++n) t.mean_mN += recent[n] / MEAN;
    t.strain = ((double)f.w->rigid.states[1].position[0] - f.w->rigid.states[0].position[0]) /
                   (right - left) - 1;
    break;
  }
  return t;
}

static void the_force_at_the_first_tear_grows_with_the_substeps(void) {
  double before = 0;
  double first = 0;
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (uint32_t n = 0; n < TRIED; ++n) {
    char name[64];
    const first_tear t = pull_apart(substeps_tried[n]);
    snprintf(name, sizeof name, "first_tear_force_%u_substeps", substeps_tried[n]);
    figure(name, t.peak_mN, "mN", "grows");
    snprintf(name, sizeof name, "first_tear_mean_force_%u_substeps", substeps_tried[n]);
    figure(name, t.mean_mN, "mN", "printed");
    snprintf(name, sizeof name, "first_tear_stretch_%u_substeps", substeps_tried[n]);
    figure(name, 100 * t.strain, "%", "printed");
    CHECK(t.tick > 0);
    CHECK(t.peak_mN > before);
    before = t.peak_mN;
    if (n == 0) first = t.peak_mN;
    const double x = log(substeps_tried[n]);
    const double y = log(fmax(t.peak_mN, 1e-3));
    sx += x;
    sy += y;
    sxx += x * x;
    sxy += x * y;
  }
  const double exponent = (TRIED * sxy - sx * sy) / (TRIED * sxx - sx * sx);
  figure("first_tear_force_exponent", exponent, "", "about 2: plain projection");
  figure("first_tear_force_32_over_4_substeps", before / first, "", "at least 10");
  CHECK(before >= 10 * first);
}

int main(void) {
  TEST(the_force_at_the_first_tear_grows_with_the_substeps);
  return test_end();
}
