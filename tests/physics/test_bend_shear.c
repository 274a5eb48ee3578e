/* SPDX-License-Identifier: Apache-2.0 */
/* Bend and shear springs of woven cloth by themselves (Metaaphanon 2009, section 3.2): a shear spring, the diagonal of
 * a cell, gives k x dt / m a tick where it is pressed and nothing where it is stretched; a bend spring, over two
 * spacings, gives it both ways. Against the law in double. */
#include "tests/lib/test.h"

#include "rt/woven/woven.h"
#include "tests/lib/world_fixture.h"

enum { WARPS = 3 };
static const double spacing = 1.0 / 12; /* cm */

typedef struct {
  double pull; /* what the far column is pulled back by, cm/s */
  int64_t sum; /* of all speeds, Q28 lu a substep */
} tick_gain;

/* Three columns of two crossings, of which the last lies at `share` of its distance from the first; or, in shear, is
 * moved along the column by `share` of a spacing. */
static tick_gain gain_of(const char *springs, double share, int sheared) {
  fixture_scoped f = {0};
  tick_gain gain = {0, 0};
  fixture_print(&f, "scene s\nrate 240 Hz\nsubsteps 1\niterations 1\ngravity 0 0 0 cm/s2\nwoven {\n warps 3\n wefts 2\n"
                " spacing 12 /cm\n density 0.25 g/cm2\n tear off\n drag 0 /s\n structural 6000 g/s2\n %s\n}\n", springs);
  fray_world *w = f.w;
  const double step = spacing / fixture_lu_cm(&f) * 0x1p24;
  for (uint32_t c = 0; c < WARPS * 2; ++c) {
    const uint32_t p = w->woven.crossing_particle[c];
    const uint32_t warp = c % WARPS;
    w->p.x[p] = (int32_t)lrint(step * (sheared ? warp : warp * share));
    w->p.y[p] = (int32_t)lrint(step * (sheared && warp == 2 ? share : 0.0)) - (int32_t)lrint(step * (c / WARPS));
    w->p.z[p] = 0;
  }
  bend_shear_apply(w);
  for (uint32_t p = 0; p < w->p.count; ++p) gain.sum += (int64_t)w->p.vx[p] + w->p.vy[p] + w->p.vz[p];
  const uint32_t far = w->woven.crossing_particle[2];
  gain.pull = -(sheared ? w->p.vy[far] : w->p.vx[far]) * fixture_speed(&f);
  return gain;
}

/* k (length - rest) dt / m of one spring. */
static double law(double k, double over) { return k * over / 240 / (0.25 * spacing * spacing); }

static void check(const char *name, double share, tick_gain gain, double asked, double whole) {
  printf("figure %s_%+.2f %.6f cm/s a tick for %.6f (asked: off by at most 0.003 of what the rest length would give)\n", name,
         share, gain.pull, asked);
  CHECK(fabs(gain.pull - asked) <= 0.003 * whole);
  CHECK((gain.pull > 0) == (asked > 0) && (gain.pull < 0) == (asked < 0));
  CHECK(gain.sum == 0);
}

static void bend_holds_both_ways(void) {
  static const double shares[] = {0.8, 0.9, 0.95, 0.99, 1.0, 1.01, 1.05, 1.2, 1.3};
  for (uint32_t n = 0; n < sizeof shares / sizeof shares[0]; ++n) {
    const tick_gain gain = gain_of("bend 5 g/s2\n shear 0 g/s2", shares[n], 0);
    check("bend", shares[n] - 1, gain, law(5, 2 * spacing * (shares[n] - 1)), law(5, 2 * spacing));
  }
}

/* The upper crossing of the column has one diagonal, to the lower one of the column before: longer where the column is
 * moved up, shorter where it is moved down. */
static void shear_holds_where_pressed(void) {
  static const double moved[] = {-0.2, -0.1, -0.05, -0.02, -0.01, 0, 0.01, 0.02, 0.05, 0.1, 0.2};
  for (uint32_t n = 0; n < sizeof moved / sizeof moved[0]; ++n) {
    const double along = 1 + moved[n];
    const double length = spacing * sqrt(1 + along * along);
    const double pressed = fmin(length - spacing * sqrt(2), 0);
    const tick_gain gain = gain_of("bend 0 g/s2\n shear 2 g/s2", moved[n], 1);
    check("shear", moved[n], gain, law(2, pressed) * along * spacing / length, law(2, spacing * sqrt(2)));
    if (moved[n] >= 0) CHECK(gain.pull == 0);
  }
}

int main(void) {
  TEST(bend_holds_both_ways);
  TEST(shear_holds_where_pressed);
  return test_end();
}
