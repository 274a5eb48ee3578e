/* SPDX-License-Identifier: Apache-2.0 */
/* Stiffness and stress of a strain: material.h has formulas and formats. SIMD twin:
 * rt/simd/membrane_stress_lanes.inl.h. */
#include "rt/state/material.h"

const int32_t material_arctan[5] = {73341837, -40308673, 25412288, -13093830, 3423385};

static int32_t arctan(int32_t t) {
  const int32_t z = fx_mul_round(t, t, STRAIN_BITS);
  int32_t q = material_arctan[4];
  for (uint32_t n = 4; n > 0; --n)
    q = material_arctan[n - 1u] + fx_mul_round(q, z, STRAIN_BITS);
  return fx_mul_round(t, STRAIN_ONE + fx_mul_round(q, STRAIN_ONE - z, STRAIN_BITS), STRAIN_BITS);
}

int32_t material_direction(int32_t x, int32_t y) {
  FRAY_ASSERT(y >= 0 && (x != 0 || y != 0));
  const uint32_t ax = fx_magnitude(x);
  const uint32_t ay = (uint32_t)y;
  const uint32_t smaller = ax < ay ? ax : ay;
  const uint32_t larger = ax < ay ? ay : ax;
  const int32_t t = (int32_t)fx_divide_wide((uint64_t)smaller << STRAIN_BITS, larger);
  const int32_t first = ax < ay ? 2 * STRAIN_ONE - arctan(t) : arctan(t);
  return x < 0 ? 4 * STRAIN_ONE - first : first;
}

/* a + (b - a) fraction, Q28 of 0..1. */
static int32_t lerp(int32_t a, int32_t b, int32_t fraction) {
  FRAY_ASSERT(fraction >= 0 && fraction <= STRAIN_ONE);
  return a + fx_mul_round(fx_sub(b, a), fraction, STRAIN_BITS);
}

/* Q28 of 0..1, of the larger principal strain, Q28. */
static int32_t level_of(int64_t largest) {
  if (largest <= 0) return 0;
  const uint64_t squared = (uint64_t)(STRAIN_ONE + 2 * largest) << STRAIN_BITS;
  const int64_t stretch = fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
  return (int32_t)fx_clamp64(6 * (stretch - STRAIN_ONE), 0, STRAIN_ONE);
}

/* Q28 of 0..1: 0 where the principal strains are the same. spread is half of their difference. */
static int32_t anisotropy_of(int64_t spread, int64_t largest) {
  const int64_t sixteen = 16 * spread;
  if (sixteen >= largest) return STRAIN_ONE;
  return (int32_t)fx_divide_wide((uint64_t)sixteen << (STRAIN_BITS - 4), (uint32_t)(largest >> 4) + 1u);
}

/* Entry n over all directions. */
static int32_t mean_of(const material_table *f, uint32_t n) {
  const int64_t ends = (int64_t)f->stretch[1][n] + f->stretch[5][n];
  const int64_t inner = (int64_t)f->stretch[2][n] + f->stretch[3][n] + f->stretch[4][n];
  return (int32_t)fx_round64(ends + 2 * inner, 3);
}

/* Position of a strain in the table. */
typedef struct {
  fx_root root; /* of x^2 + y^2, if that is not 0 */
  int32_t x, y; /* half the difference of uu and vv, half of |uv|: their length is half the difference
                   of the principal strains */
  uint64_t squared;
  int32_t level, anisotropy; /* Q28 of 0..1 */
  uint32_t row;
  int32_t fraction; /* Q28, from this row to the next */
} material_place;

static material_place place_of(material_tensor strain) {
  material_place p;
  p.x = fx_asr(fx_sub(strain.uu, strain.vv), 1);
  p.y = (int32_t)(fx_magnitude(strain.uv) >> 1);
  p.squared = fx_square(p.x) + fx_square(p.y);
  p.root = fx_rsqrt(p.squared == 0 ? 1 : p.squared, FX_ROOT_FINE);
  const int64_t spread = p.squared == 0 ? 0 : fx_root_length(p.root);
  const int64_t largest = fx_asr64((int64_t)strain.uu + strain.vv, 1) + spread;
  p.level = level_of(largest);
  p.anisotropy = p.level == 0 ? 0 : anisotropy_of(spread, largest);
  const int32_t at = p.anisotropy == 0 ? 0 : material_direction(p.x, p.y);
  p.row = (uint32_t)fx_min(at >> STRAIN_BITS, MATERIAL_ROWS - 3);
  p.fraction = at - (int32_t)(p.row << STRAIN_BITS);
  return p;
}

/* Entry n between the rows of directions, at a full level. */
static int32_t row_entry(const material_table *f, const material_place *p, uint32_t n) {
  const int32_t row = lerp(f->stretch[1 + p->row][n], f->stretch[2 + p->row][n], p->fraction);
  return p->anisotropy == STRAIN_ONE ? row : lerp(mean_of(f, n), row, p->anisotropy);
}

void material_stiffness(const material_table *f, material_tensor strain, int32_t c[MATERIAL_ENTRIES]) {
  FRAY_ASSERT(strain.uu >= -STRAIN_MAX && strain.uu <= STRAIN_MAX);
  FRAY_ASSERT(strain.vv >= -STRAIN_MAX && strain.vv <= STRAIN_MAX);
  const material_place p = place_of(strain);
  for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n)
    c[n] = lerp(f->stretch[0][n], row_entry(f, &p, n), p.level);
}
