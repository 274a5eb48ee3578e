/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/model/fabric.h"

const int32_t fabric_eighth[5] = {73341837, -40308673, 25412288, -13093830, 3423385};

static int32_t eighth(int32_t t) {
  const int32_t z = (int32_t)fx_round64(fx_mul_wide(t, t), STRAIN_BITS);
  int32_t q = fabric_eighth[4];
  for (uint32_t n = 4; n > 0; --n)
    q = fabric_eighth[n - 1u] + (int32_t)fx_round64(fx_mul_wide(q, z), STRAIN_BITS);
  const int32_t factor =
      STRAIN_ONE + (int32_t)fx_round64(fx_mul_wide(q, STRAIN_ONE - z), STRAIN_BITS);
  return (int32_t)fx_round64(fx_mul_wide(t, factor), STRAIN_BITS);
}

int32_t fabric_direction(int32_t x, int32_t y) {
  const uint32_t across = fx_magnitude(x);
  const uint32_t up = (uint32_t)y;
  const uint32_t least = across < up ? across : up;
  const uint32_t most = across < up ? up : across;
  const int32_t t = (int32_t)fx_divide_wide((uint64_t)least << STRAIN_BITS, most);
  const int32_t first = across < up ? 2 * STRAIN_ONE - eighth(t) : eighth(t);
  return x < 0 ? 4 * STRAIN_ONE - first : first;
}

/* a, and b after `share`, Q28 of 0..1. */
static int32_t between(int32_t a, int32_t b, int32_t share) {
  return a + (int32_t)fx_round64(fx_mul_wide(fx_sub(b, a), share), STRAIN_BITS);
}

/* Q28 of 0..1, from what the larger principal strain, Q28, is. */
static int32_t level_of(int64_t largest) {
  if (largest <= 0) return 0;
  const uint64_t squared = (uint64_t)(STRAIN_ONE + 2 * largest) << STRAIN_BITS;
  const int64_t stretch = fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
  return (int32_t)fx_clamp64(6 * (stretch - STRAIN_ONE), 0, STRAIN_ONE);
}

/* Q28 of 0..1: how far the principal strains are from being the same. spread is half of what they
 * differ. */
static int32_t distinct(int64_t spread, int64_t largest) {
  const int64_t sixteen = 16 * spread;
  if (sixteen >= largest) return STRAIN_ONE;
  return (int32_t)fx_divide_wide((uint64_t)sixteen << (STRAIN_BITS - 4),
                                 (uint32_t)(largest >> 4) + 1u);
}

/* Over all directions. */
static int32_t mean_of(const fabric *f, uint32_t n) {
  const int64_t ends = (int64_t)f->stretch[1][n] + f->stretch[5][n];
  const int64_t inner = (int64_t)f->stretch[2][n] + f->stretch[3][n] + f->stretch[4][n];
  return (int32_t)fx_round64(ends + 2 * inner, 3);
}

/* Where a strain stands in the table. */
typedef struct {
  fx_root root; /* of x^2 + y^2, if that is not 0 */
  int32_t x, y; /* half the difference of uu and vv, half of |uv|: their length is half of what the
                   principal strains differ */
  uint64_t squared;
  int32_t level, apart; /* Q28 of 0..1 */
  uint32_t row;
  int32_t share; /* Q28 of the way to the next row */
} fabric_place;

static fabric_place place_of(tensor strain) {
  fabric_place p;
  p.x = fx_asr(fx_sub(strain.uu, strain.vv), 1);
  p.y = (int32_t)(fx_magnitude(strain.uv) >> 1);
  p.squared = fx_square(p.x) + fx_square(p.y);
  p.root = fx_rsqrt(p.squared == 0 ? 1 : p.squared, FX_ROOT_FINE);
  const int64_t spread = p.squared == 0 ? 0 : fx_root_length(p.root);
  const int64_t largest = fx_asr64((int64_t)strain.uu + strain.vv, 1) + spread;
  p.level = level_of(largest);
  p.apart = p.level == 0 ? 0 : distinct(spread, largest);
  const int32_t at = p.apart == 0 ? 0 : fabric_direction(p.x, p.y);
  p.row = (uint32_t)fx_min(at >> STRAIN_BITS, FABRIC_ROWS - 3);
  p.share = at - (int32_t)(p.row << STRAIN_BITS);
  return p;
}

/* Entry n of the row between the directions, at a full level. */
static int32_t stretched_of(const fabric *f, const fabric_place *p, uint32_t n) {
  const int32_t row = between(f->stretch[1 + p->row][n], f->stretch[2 + p->row][n], p->share);
  return p->apart == STRAIN_ONE ? row : between(mean_of(f, n), row, p->apart);
}

void fabric_stiffness(const fabric *f, tensor strain, int32_t c[FABRIC_ENTRIES]) {
  const fabric_place p = place_of(strain);
  for (uint32_t n = 0; n < FABRIC_ENTRIES; ++n)
    c[n] = between(f->stretch[0][n], stretched_of(f, &p, n), p.level);
}

static int32_t bounded(int64_t stress_q40) {
  return (int32_t)fx_clamp64(fx_round64(stress_q40, STRAIN_BITS), -INT32_MAX, INT32_MAX);
}

tensor fabric_stress(const int32_t c[FABRIC_ENTRIES], tensor strain) {
  const tensor s = {bounded(fx_mul_wide(c[0], strain.uu) + fx_mul_wide(c[1], strain.vv)),
                    bounded(fx_mul_wide(c[1], strain.uu) + fx_mul_wide(c[2], strain.vv)),
                    bounded(fx_mul_wide(c[3], strain.uv))};
  return s;
}
