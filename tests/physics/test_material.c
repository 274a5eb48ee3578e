/* SPDX-License-Identifier: Apache-2.0 */
/* Stress by direction and level against double precision: a million random strains of random
 * cloths, and the places where rows begin. */
#include <stdlib.h>

#include "rt/base/random.h"
#include "tests/lib/test.h"
#include "tests/physics/material_reference.h"

enum { STRAINS = 1000000 };

static uint32_t drawn;
static int32_t draw(int32_t least, int32_t most) {
  return random_between(11, drawn++, least, most);
}

static material_table random_cloth(void) {
  material_table f = {0};
  const int32_t stiff = 1 << draw(17, 27);
  for (uint32_t r = 0; r < MATERIAL_ROWS; ++r) {
    f.stretch[r][0] = draw(stiff / 4, stiff);
    f.stretch[r][1] = draw(0, stiff / 4);
    f.stretch[r][2] = draw(stiff / 4, stiff);
    f.stretch[r][3] = draw(stiff / 64, stiff / 2);
  }
  return f;
}

static double largest_entry(const material_table *f) {
  double most = 0;
  for (uint32_t r = 0; r < MATERIAL_ROWS; ++r)
    for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n) most = fmax(most, f->stretch[r][n] / 4096.0);
  return most;
}

static reference_tensor real(material_tensor g, double unit) {
  const reference_tensor r = {g.uu / unit, g.vv / unit, g.uv / unit};
  return r;
}

/* Bounds: 2e-5 of the largest entry in c, and half a step of 2^-12 N/m in the stress of that c. */
static void stiffness_is_the_oracles(void) {
  double worst_c = 0;
  double worst_s = 0;
  material_table f = random_cloth();
  for (uint32_t n = 0; n < STRAINS; ++n) {
    if (n % 1000 == 0) f = random_cloth();
    const int32_t span = 1 << draw(12, 28);
    material_tensor g = {draw(-span, span), draw(-span, span), draw(-span, span)};
    g.uu = fx_max(g.uu, -STRAIN_ONE / 2);
    g.vv = fx_max(g.vv, -STRAIN_ONE / 2);
    int32_t c[MATERIAL_ENTRIES];
    double expected[MATERIAL_ENTRIES];
    material_stiffness(&f, g, c);
    reference_stiffness(&f, real(g, STRAIN_ONE), expected);
    const double most = largest_entry(&f);
    for (uint32_t e = 0; e < MATERIAL_ENTRIES; ++e)
      worst_c = fmax(worst_c, fabs(c[e] / 4096.0 - expected[e]) / most);
    const material_tensor s = material_stress(c, g);
    const reference_tensor r = real(g, STRAIN_ONE);
    const double uu = (c[0] * r.uu + c[1] * r.vv) / 4096;
    const double vv = (c[1] * r.uu + c[2] * r.vv) / 4096;
    const double uv = c[3] * r.uv / 4096;
    worst_s = fmax(worst_s, fmax(fabs(s.uu / 4096.0 - uu), fabs(s.vv / 4096.0 - vv)));
    worst_s = fmax(worst_s, fabs(s.uv / 4096.0 - uv));
  }
  printf("figure stiffness against double, worst %.2g of the largest entry (asked: 2e-05)\n",
         worst_c);
  printf("figure stress of it, worst %.2g N/m (asked: 0.00013)\n", worst_s);
  CHECK(worst_c < 2e-5);
  CHECK(worst_s < 1.3e-4);
}

/* One row stands out: it must be there at its own angle, and at no other. */
static void rows_stand_at_their_angles(void) {
  const double pi = acos(-1.0);
  for (uint32_t row = 1; row < MATERIAL_ROWS; ++row) {
    material_table f = {0};
    for (uint32_t e = 0; e < MATERIAL_ENTRIES; ++e) f.stretch[row][e] = 4096000;
    for (uint32_t at = 1; at < MATERIAL_ROWS; ++at) {
      const double angle = (at - 1) * pi / 8;
      for (int mirrored = -1; mirrored < 2; mirrored += 2) {
        /* 0.4 along it, nothing across: a stretch of 1.34 */
        const material_tensor g = {(int32_t)lrint(0.4 * cos(angle) * cos(angle) * STRAIN_ONE),
                          (int32_t)lrint(0.4 * sin(angle) * sin(angle) * STRAIN_ONE),
                          mirrored * (int32_t)lrint(0.8 * sin(angle) * cos(angle) * STRAIN_ONE)};
        int32_t c[MATERIAL_ENTRIES];
        material_stiffness(&f, g, c);
        for (uint32_t e = 0; e < MATERIAL_ENTRIES; ++e)
          CHECK(at == row ? c[e] > 4096000 - 100 : c[e] < 100);
      }
    }
  }
}

static void level_is_full_from_a_sixth_on(void) {
  material_table f = {0};
  for (uint32_t r = 1; r < MATERIAL_ROWS; ++r) f.stretch[r][0] = 4096000;
  f.stretch[0][0] = 1024000;
  int32_t c[MATERIAL_ENTRIES];
  const struct {
    double stretch;
    int32_t expected;
  } cases[] = {{0.9, 1024000},
               {1, 1024000},
               {1 + 1.0 / 12, 2560000},
               {1 + 1.0 / 6, 4096000},
               {1.5, 4096000}};
  for (uint32_t n = 0; n < sizeof cases / sizeof cases[0]; ++n) {
    const double s = cases[n].stretch;
    const material_tensor g = {(int32_t)lrint((s * s - 1) / 2 * STRAIN_ONE), s < 1 ? -STRAIN_ONE / 4 : 0, 0};
    material_stiffness(&f, g, c);
    CHECK(abs(c[0] - cases[n].expected) <= 1);
  }
}

int main(void) {
  TEST(stiffness_is_the_oracles);
  TEST(rows_stand_at_their_angles);
  TEST(level_is_full_from_a_sixth_on);
  return test_end();
}
