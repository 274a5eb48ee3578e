/* SPDX-License-Identifier: Apache-2.0 */
/* The hanging sheet of 80 x 40 crossings against the same algorithm in double precision, and
 * against what that run makes of a start that is off by up to 1e-6 lu.
 *
 * The sheet forgets its start (a perturbation of 1e-6 lu shrinks), so after 5 s the error of fixed
 * point is that of the place where it comes to rest. The bound, for yarns of n links of length s
 * with weight below them:
 * - length: f, about strain / 2, is rounded to Q20 and u, about 2 strain, too: 1.25 * 2^-20 of
 *   strain a link, together 1.25 * 2^-20 n s. And f is in error by a share: 1/R^2 is cut to an
 *   integer (`inverse`, about 2300) and psi to 1/2048, so the stretch that carries the sheet's
 *   weight is off by up to (1/inverse + 1/2048) of itself;
 * - direction, rounding of the push: the link that carries k crossings takes back k g h^2 in a
 *   substep; across itself it does so in whole position steps of 2^-24 lu, so an angle below
 *   1/2 step / (k g h^2) goes unseen: s (1 + 1/2 + ... + 1/n) / (2 g h^2 in steps);
 * - direction, rounding of d to units of 2^8 steps: an angle of 2^7 steps / s; together n 2^7.
 * The last two may stand in both directions across the yarn: times sqrt 2. */
#include "tests/lib/test.h"
#include "tests/physics/woven_reference.h"

/* By how much the outermost warp is longer than at rest, in lu. */
static double stretch_of(const fray_world *w) {
  double sum = 0;
  for (uint32_t j = 0; j + 1 < (uint32_t)w->params->wefts; ++j) {
    const uint32_t row =
        w->woven.spring_of[(uint32_t)w->params->wefts * ((uint32_t)w->params->warps - 1) +
                  j * (uint32_t)w->params->warps];
    sum += fabs(fixture_length(w, row) - fixture_rest(w, row)) * 0x1p-24;
  }
  return sum;
}

static double bound_of(const fixture *f, int still_flat) {
  const params *p = f->w->params;
  const double s = f->w->woven.link_classes[2].rest * 0x1p-24;
  const double n = p->wefts - 1;
  const double fall = -(p->gravity_y + 1.0) / (1 << FX_SUB_BITS); /* g h^2 in position steps */
  double harmonic = 0;
  for (int k = 1; k < p->wefts; ++k) harmonic += 1.0 / k;
  const double length = 1.25 * 0x1p-20 * n * s +
                        stretch_of(f->w) * (1.0 / f->w->woven.link_classes[2].inverse + 1.0 / 2048);
  const double across = s * harmonic / (2 * fall) + n * 128 * 0x1p-24;
  return length + (still_flat ? 0 : sqrt(2) * across);
}

static void compare(const char *label, const char *gather, uint32_t ticks, int flat) {
  fixture_scoped f = {0};
  woven_reference exact_run;
  woven_reference other;
  uint64_t seed = 1;
  char name[64];
  fixture_hanging(&f, 80, 40, 6, "0 s", gather, "0.5 /s");
  woven_reference_open(&exact_run, f.w);
  woven_reference_open(&other, f.w);
  for (uint32_t n = other.held; n < other.particles; ++n)
    for (uint32_t a = 0; a < 3; ++a)
      other.x[n][a] += ((double)(splitmix64(&seed) >> 11) * 0x1p-52 - 1) * 1e-6;
  for (uint32_t tick = 1; tick <= ticks; ++tick) {
    (void)fixture_tick(&f, &fixture_idle);
    woven_reference_tick(&exact_run);
    woven_reference_tick(&other);
  }
  const double error = woven_reference_error(&exact_run, f.w);
  const double bound = bound_of(&f, flat);
  char asked[64];
  snprintf(asked, sizeof asked, "at most %.3g", bound);
  snprintf(name, sizeof name, "double_sheet_%s_rms_error_%u_ticks", label, ticks);
  figure(name, error, "lu", asked);
  snprintf(name, sizeof name, "double_sheet_%s_rms_error_of_spacing", label);
  figure(name, 100 * error / (f.w->woven.link_classes[1].rest * 0x1p-24), "%", "printed");
  snprintf(name, sizeof name, "double_sheet_%s_rms_sensitivity_to_1e-6_lu", label);
  figure(name, woven_reference_distance(&exact_run, &other), "lu", "printed");
  CHECK(error <= bound);
  CHECK(error > 0);
  woven_reference_close(&exact_run);
  woven_reference_close(&other);
}

static void a_sheet_that_swings_out_rests_where_double_does(void) {
  compare("gathered", "5 %", 5000, 0);
}
/* Nothing drives a flat sheet out of its plane: only lengths can be wrong. */
static void a_flat_sheet_rests_where_double_does(void) { compare("flat", "0 %", 1500, 1); }

int main(void) {
  TEST(a_sheet_that_swings_out_rests_where_double_does);
  TEST(a_flat_sheet_rests_where_double_does);
  return test_end();
}
