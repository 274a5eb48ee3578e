/* SPDX-License-Identifier: Apache-2.0 */
/* Couples that slip: every kernel that this machine has against the scalar stage, to the last bit. Sheets
 * of whole crossings, couples and cut springs in random patterns; particles where the sheet has them and
 * thrown together, in a plane, on a line, at one point, apart by the size of the world.
 *
 *   test_simd_yarn_slip [COUPLES]     2,000,000 unless told, a tenth under sanitizers */
#define _DEFAULT_SOURCE 1 /* mmap without a file */
#include "tests/lib/test.h"

#include "rt/state/crossing.h"
#include "rt/woven/woven.h"
#include "tests/lib/guarded.h"
#include "tests/lib/simd_kernels.h"
#include "tests/lib/world_fixture.h"

enum { WARPS = 13, WEFTS = 11, MOST = 2 * WARPS * WEFTS, AXES = 9, ROUNDS = 60 };

static uint64_t couples_asked = GUARDED_SLOW ? 200000 : 2000000;

typedef struct {
  int32_t word[AXES][MOST];
  body_motion motion;
} places;

static int32_t *axis_of(const fray_world *w, int n) {
  int32_t *const axes[AXES] = {w->p.x, w->p.y, w->p.z, w->p.qx, w->p.qy, w->p.qz, w->p.vx, w->p.vy, w->p.vz};
  return axes[n];
}

static void take(const fray_world *w, places *p) {
  memset(p, 0, sizeof *p);
  for (int n = 0; n < AXES; ++n) memcpy(p->word[n], axis_of(w, n), 4 * w->p.count);
  p->motion = w->rigid.motion[0];
}

static void give(fray_world *w, const places *p) {
  for (int n = 0; n < AXES; ++n) memcpy(axis_of(w, n), p->word[n], 4 * w->p.count);
  w->rigid.motion[0] = p->motion;
}

/* Which crossings are couples, and what is cut. */
static void make_sheet(fixture *f) {
  fixture_print(f, "scene slides\nrate 1000 Hz\nsubsteps 4\nseed 5\nwoven {\n warps %d\n wefts %d\n"
                   " spacing 12 /cm\n weave %s\n yarns on\n}\npin row top\n",
                WARPS, WEFTS, draw_below(2) == 0 ? "plain" : "twill 2/1");
  const uint32_t whole = draw_below(4);
  const uint32_t cuts = draw_below(3) == 0 ? 0 : draw_below(60);
  for (uint32_t c = 0; c < WARPS * WEFTS; ++c)
    if (!crossing_is_attached(f->w, c) && draw_below(4) >= whole)
      crossing_split(f->w, c, draw_below(20) == 0 ? FRAY_CONNECTED : FRAY_LOOSE);
  for (uint32_t c = 0; c < WARPS * WEFTS; ++c)
    if (crossing_state_at(f->w, c) == FRAY_LOOSE && draw_below(10) == 0) crossing_set_state(f->w, c, FRAY_DISCONNECTED);
  for (uint32_t n = 0; n < cuts; ++n) world_kill_spring(f->w, draw_below((uint32_t)f->w->params->links));
}

/* Constants stand in the image, which is ours. */
static void make_constants(const fray_world *w) {
  params *p = (params *)(uintptr_t)w->params;
  yarn_params *y = (yarn_params *)(uintptr_t)w->woven.yarn_constants;
  p->thickness = draw_below(4) == 0 ? (int32_t)draw_below(1u << draw_below(25)) : 167772;
  y->slip_friction = draw_below(3) == 0 ? 0 : (int32_t)draw_below(1u << (1 + draw_below(20)));
  y->crossing_friction = draw_below(3) == 0 ? 0 : (int32_t)draw_below(1u << (1 + draw_below(24)));
}

static int32_t placed(int32_t home, uint32_t most) {
  return (int32_t)fx_clamp64((int64_t)home + draw_below(most) - (int64_t)(most / 2), -FX_WORLD_MAX, FX_WORLD_MAX);
}

static void make_places(const fray_world *w, places *p) {
  const uint32_t away = 1u << (2 + draw_below(draw_below(8) == 0 ? 29 : 19));
  const uint32_t step = 1u << (2 + draw_below(draw_below(8) == 0 ? 24 : 14));
  const uint32_t shape = draw_below(8);
  take(w, p);
  for (uint32_t k = 0; k < w->p.count; ++k)
    for (uint32_t a = 0; a < 3; ++a) {
      const int flat = shape == 0 ? a == 2 : shape == 1 ? a != 0 : shape == 2 && draw_below(3) != 0;
      if (flat && shape != 2) p->word[a][k] = 0;
      if (!flat) p->word[a][k] = placed(p->word[a][k], away);
      if (draw_below(50) == 0 && k > 0) p->word[a][k] = p->word[a][k - 1];
      p->word[3 + a][k] = placed(p->word[a][k], step);
      p->word[6 + a][k] = placed(0, step << 4);
    }
}

static uint32_t slip(fray_world *w, const places *from, fray_kernel kernel, places *to) {
  fray_set_kernel(w, kernel);
  give(w, from);
  w->work.slips = 0;
  for (uint32_t n = 0; n < 3; ++n) yarn_slip_apply(w, n);
  take(w, to);
  return w->work.slips / 3;
}

static void couples_are_as_scalar(void) {
  static places given, home, expected, found;
  fray_kernel kernels[SIMD_KERNELS];
  const uint32_t count = simd_kernels(kernels);
  uint64_t different[SIMD_KERNELS] = {0};
  uint64_t couples = 0;
  uint64_t still = 0;
  while (couples < couples_asked) {
    fixture_scoped f = {0};
    make_sheet(&f);
    take(f.w, &home);
    for (uint32_t round = 0; round < ROUNDS; ++round) {
      give(f.w, &home);
      make_constants(f.w);
      make_places(f.w, &given);
      const uint32_t slips = slip(f.w, &given, FRAY_KERNEL_SCALAR, &expected);
      couples += slips;
      still += memcmp(&given, &expected, sizeof given) == 0;
      for (uint32_t k = 0; k < count; ++k)
        different[k] += slip(f.w, &given, kernels[k], &found) != slips ||
                        memcmp(&expected, &found, sizeof found) != 0;
    }
  }
  CHECK(still < couples / 1000);
  simd_report("couples", "sheets", kernels, count, couples, different);
}

int main(int argc, char **argv) {
  if (argc > 1) couples_asked = strtoull(argv[1], NULL, 10);
  TEST(couples_are_as_scalar);
  return test_end();
}
