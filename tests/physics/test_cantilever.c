/* SPDX-License-Identifier: Apache-2.0 */
/* Bending of membranes: a strip and its mirror image, held along the line between them, hang down on both
 * sides under their own weight; their ends sink as far as that of an elastica of the measured stiffness, solved by
 * shooting in double. On regular, turned and irregular meshes, as bending is the cloth's and not the mesh's. */
#include "tests/lib/double_strip.h"
#include "tests/lib/test.h"

enum { PIECES = 4000 };

/* t'' = -(w / D)(L - s) cos t, t(0) = 0, t'(L) = 0; returns how far the end is below, in units of
 * L. */
static double elastica(double load) {
  double low = 0;
  double high = 4 * load;
  double sunk = 0;
  for (int round = 0; round < 100; ++round) {
    double t = 0;
    double turn = (low + high) / 2;
    const double h = 1.0 / PIECES;
    sunk = 0;
    for (int n = 0; n < PIECES; ++n) {
      const double s = (n + 0.5) * h;
      const double middle = t + turn * h / 2;
      sunk += sin(middle) * h;
      turn -= load * (1 - s) * cos(middle) * h;
      t += turn * h;
    }
    if (turn > 0)
      high = (low + high) / 2;
    else
      low = (low + high) / 2;
  }
  return sunk;
}

enum { LENGTH_MM = 60, TICKS = 1200 };

static const char *const patterns[] = {"regular",        "rotated 15 deg", "rotated 30 deg", "rotated 45 deg",
                                       "irregular 1",    "irregular 2",    "irregular 3"};
enum { PATTERNS = sizeof patterns / sizeof patterns[0] };

static int every_mesh;

/* How far the ends are off, as a share; D along the strip in uNm. */
static double run(const char *pattern, const char *material, double stiffness_uNm, int warp, int columns) {
  const double density = 0.2;
  const double gravity = 9.81;
  const double length = LENGTH_MM * 1e-3;
  const double_strip strip = {pattern, material, warp, columns, columns * 2 / 5, LENGTH_MM * 0.1 / columns};
  fixture_scoped f = {0};
  double_strip_open(&f, &strip);
  for (int tick = 0; tick < TICKS; ++tick) fixture_tick(&f, &fixture_idle);
  const double lu = f.facts.lu_um * 1e-6;
  const int32_t *along = double_strip_along(f.w, &strip);
  double end = 0;
  double count = 0;
  for (uint32_t p = 0; p < f.w->p.count; ++p)
    if (fabs(fabs(along[p] / (double)FX_LU * lu) - length) < 1e-6) {
      end -= f.w->p.y[p] / (double)FX_LU * lu;
      count += 1;
    }
  const double load = density * gravity * length * length * length / (stiffness_uNm * 1e-6);
  return end / count / (elastica(load) * length) - 1;
}

static void strips(const char *name, const char *material, double stiffness_uNm, int warp, int columns, double bound) {
  double worst = 0;
  printf("figure cantilever %-12s %2d x %d:", name, columns, columns * 2 / 5);
  for (size_t n = 0; n < PATTERNS; n += (columns > 10 && !every_mesh ? 3U : 1U) * TEST_FEWER) {
    fflush(stdout);
    const double off = run(patterns[n], material, stiffness_uNm, warp, columns);
    printf(" %s %+.2f", patterns[n], 100 * off);
    if (fabs(off) > worst) worst = fabs(off);
  }
  printf(" %% (asked: %.1f)\n", 100 * bound);
  CHECK(worst < bound);
}

static void strips_sink_as_theory_says(void) {
  strips("40 uNm", " bend all 40 uNm", 40, 0, 10, 0.03);
  strips("15 uNm", " bend all 15 uNm", 15, 0, 10, 0.03);
  strips("150 uNm", " bend all 150 uNm", 150, 0, 10, 0.03);
}

static void finer_meshes_are_nearer(void) { strips("40 uNm", " bend all 40 uNm", 40, 0, 20, 0.01); }

/* Rows are by the direction of the fold line. */
#define ANISOTROPIC \
  " bend 0 20 20 20 20 20 uNm\n bend 45 12 12 12 12 12 uNm\n bend 90 40 40 40 40 40 uNm"

static void anisotropic_strips_too(void) {
  strips("weft of 3", ANISOTROPIC, 40, 0, 10, 0.04);
  strips("warp of 3", ANISOTROPIC, 20, 1, 10, 0.04);
  strips("weft of 3", ANISOTROPIC, 40, 0, 20, 0.025);
  strips("warp of 3", ANISOTROPIC, 20, 1, 20, 0.025);
}

/* `all` hangs fine strips of every mesh, by default of every third. */
int main(int count, char **words) {
  every_mesh = count > 1 && strcmp(words[1], "all") == 0;
  TEST(strips_sink_as_theory_says);
  TEST(finer_meshes_are_nearer);
  TEST(anisotropic_strips_too);
  return test_end();
}
