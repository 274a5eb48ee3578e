/* SPDX-License-Identifier: Apache-2.0 */
/* Couples that slip: every kernel that this machine has against the scalar stage, to the last bit. Sheets
 * of whole crossings, couples and cut springs in random patterns; particles where the sheet has them and
 * thrown together, in a plane, on a line, at one point, apart by the size of the world.
 *
 *   test_wide_slides [COUPLES]     2,000,000 unless told, a tenth under sanitizers */
#define _DEFAULT_SOURCE 1 /* mmap without a file */
#include "tests/lib/test.h"

#include "rt/model/couples.h"
#include "rt/stage/stage.h"
#include "tests/lib/guarded.h"
#include "tests/lib/wide_kernels.h"
#include "tests/lib/world_fixture.h"

enum { WARPS = 13, WEFTS = 11, MOST = 2 * WARPS * WEFTS, AXES = 9, ROUNDS = 60 };

static uint64_t couples_asked = GUARDED_SLOW ? 200000 : 2000000;

typedef struct {
  int32_t word[AXES][MOST];
  body_motion motion;
} places;

static int32_t *axis_of(const fray_world *w, int n) {
  int32_t *const axes[AXES] = {w->x, w->y, w->z, w->qx, w->qy, w->qz, w->vx, w->vy, w->vz};
  return axes[n];
}

static void take(const fray_world *w, places *p) {
  memset(p, 0, sizeof *p);
  for (int n = 0; n < AXES; ++n) memcpy(p->word[n], axis_of(w, n), 4 * w->particles);
  p->motion = w->motion[0];
}

static void give(fray_world *w, const places *p) {
  for (int n = 0; n < AXES; ++n) memcpy(axis_of(w, n), p->word[n], 4 * w->particles);
  w->motion[0] = p->motion;
}

/* Which crossings are couples, and what is cut. */
static void make_sheet(fixture *f) {
  fixture_print(f, "scene slides\nrate 1000 Hz\nsubsteps 4\nseed 5\nsheet {\n warps %d\n wefts %d\n"
                   " spacing 12 /cm\n weave %s\n yarns on\n}\npin row top\n",
                WARPS, WEFTS, below(2) == 0 ? "plain" : "twill 2/1");
  const uint32_t whole = below(4);
  const uint32_t cuts = below(3) == 0 ? 0 : below(60);
  for (uint32_t c = 0; c < WARPS * WEFTS; ++c)
    if (!couple_is_held(f->w, c) && below(4) >= whole)
      couple_split(f->w, c, below(20) == 0 ? FRAY_CONNECTED : FRAY_LOOSE);
  for (uint32_t c = 0; c < WARPS * WEFTS; ++c)
    if (couple_at(f->w, c) == FRAY_LOOSE && below(10) == 0) couple_change(f->w, c, FRAY_DISCONNECTED);
  for (uint32_t n = 0; n < cuts; ++n) world_kill_row(f->w, below((uint32_t)f->w->params->links));
}

/* Constants stand in the image, which is ours. */
static void make_constants(const fray_world *w) {
  params *p = (params *)(uintptr_t)w->params;
  yarn_params *y = (yarn_params *)(uintptr_t)w->yarns;
  p->thickness = below(4) == 0 ? (int32_t)below(1u << below(25)) : 167772;
  y->slip_friction = below(3) == 0 ? 0 : (int32_t)below(1u << (1 + below(20)));
  y->slip_grip = below(3) == 0 ? 0 : (int32_t)below(1u << (1 + below(24)));
}

static int32_t placed(int32_t home, uint32_t most) {
  return (int32_t)fx_clamp64((int64_t)home + below(most) - (int64_t)(most / 2), -FX_WORLD_MAX, FX_WORLD_MAX);
}

static void make_places(const fray_world *w, places *p) {
  const uint32_t away = 1u << (2 + below(below(8) == 0 ? 29 : 19));
  const uint32_t step = 1u << (2 + below(below(8) == 0 ? 24 : 14));
  const uint32_t shape = below(8);
  take(w, p);
  for (uint32_t k = 0; k < w->particles; ++k)
    for (uint32_t a = 0; a < 3; ++a) {
      const int flat = shape == 0 ? a == 2 : shape == 1 ? a != 0 : shape == 2 && below(3) != 0;
      if (flat && shape != 2) p->word[a][k] = 0;
      if (!flat) p->word[a][k] = placed(p->word[a][k], away);
      if (below(50) == 0 && k > 0) p->word[a][k] = p->word[a][k - 1];
      p->word[3 + a][k] = placed(p->word[a][k], step);
      p->word[6 + a][k] = placed(0, step << 4);
    }
}

static uint32_t slip(fray_world *w, const places *from, fray_kernel kernel, places *to) {
  fray_use(w, kernel);
  give(w, from);
  w->work.slips = 0;
  for (uint32_t n = 0; n < 3; ++n) slip_run(w, n);
  take(w, to);
  return w->work.slips / 3;
}

static void couples_are_as_scalar(void) {
  static places given, home, expected, found;
  fray_kernel kernels[WIDE_KERNELS];
  const uint32_t count = wide_kernels(kernels);
  uint64_t different[WIDE_KERNELS] = {0};
  uint64_t couples = 0;
  uint64_t still = 0;
  while (couples < couples_asked) {
    fixture f;
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
    fixture_close(&f);
  }
  CHECK(still < couples / 1000);
  for (uint32_t k = 0; k < count; ++k) {
    printf("figure couples_as_scalar_%s %llu, sheets that differ %llu (asked: 0)\n",
           wide_kernel_names[kernels[k]], (unsigned long long)couples, (unsigned long long)different[k]);
    CHECK_EQ_INT(different[k], 0);
  }
}

int main(int argc, char **argv) {
  if (argc > 1) couples_asked = strtoull(argv[1], NULL, 10);
  TEST(couples_are_as_scalar);
  return test_end();
}
