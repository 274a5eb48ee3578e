/* SPDX-License-Identifier: Apache-2.0 */
/* Stiffness and stress of triangles at the beginning of a tick, LANES at a time: stage/pull.c and
 * model/fabric.c say what is computed, in the same order. What is strained beyond 1/2, or has been left low
 * by a tear, is left to the scalar code. */
#ifndef FRAY_WIDE_STRESSES_H
#define FRAY_WIDE_STRESSES_H

#include "rt/model/element.h"
#include "rt/wide/direction.h"
#include "rt/wide/folds.h"
#include "rt/wide/pulls.h"

#ifdef LANES_LONGS
enum { STRESSES_STRAIN = 27, STRESSES_STRESS = 58 };

typedef struct {
  uint32_t of[LANES];
  lanes uu, vv, uv; /* strain, Q28 */
  lanes level, apart, share;
  int32_t row[LANES];
  int fades; /* rows fade into their mean where principal strains are nearly alike */
} stresses;

/* No weight is so great that the triangle has been left too low. */
LANES_INLINE int stresses_stout(const lanes r[4], int32_t steep) {
  const lanes u = lanes_add(r[0], r[1]);
  const lanes v = lanes_add(r[2], r[3]);
  const lanes one = longs_high(longs_add(longs_mul(r[0], r[0]), longs_mul(r[2], r[2])));
  const lanes two = longs_high(longs_add(longs_mul(r[1], r[1]), longs_mul(r[3], r[3])));
  const lanes both = longs_high(longs_add(longs_mul(u, u), longs_mul(v, v)));
  const lane_mask huge = lanes_below_zero(lanes_min(one, lanes_min(two, both)));
  const lane_mask low = lanes_above(lanes_max(one, lanes_max(two, both)), lanes_all(steep));
  return lanes_bits(lanes_either(huge, low)) == 0;
}

LANES_INLINE int stresses_strain(const stress_view *v, uint32_t first, stresses *s) {
  uint32_t id[3][LANES];
  lanes r[4], u[3], w[3];
  longs far = longs_all(0);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) {
    s->of[n] = first + n;
    for (uint32_t k = 0; k < 3; ++k) id[k][n] = v->triangle[s->of[n]].v[k];
  }
  records_take(&v->weights->u1, 4, s->of, r);
  if (!stresses_stout(r, v->steep)) return 0;
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    const lanes d1 = lanes_shl(records_way(v->at[n], id[0], id[1], ELEMENT_REACH), 4);
    const lanes d2 = lanes_shl(records_way(v->at[n], id[0], id[2], ELEMENT_REACH), 4);
    u[n] = pulls_sum(&far, d1, r[0], d2, r[1], SHEET_WEIGHT_BITS);
    w[n] = pulls_sum(&far, d1, r[2], d2, r[3], SHEET_WEIGHT_BITS);
  }
  if (longs_any_from(far, SHEET_WEIGHT_BITS + 30)) return 0;
  const longs one = longs_all((int64_t)1 << 2 * STRAIN_BITS);
  const longs uu = longs_sub(pulls_dot(u, u), one);
  const longs vv = longs_sub(pulls_dot(w, w), one);
  const longs uv = pulls_dot(u, w);
  far = longs_farther(longs_farther(longs_farther(longs_all(0), uu), vv), uv);
  s->uu = longs_round(uu, STRAIN_BITS + 1);
  s->vv = longs_round(vv, STRAIN_BITS + 1);
  s->uv = longs_round(uv, STRAIN_BITS);
  return !longs_any_from(far, STRESSES_STRAIN + STRAIN_BITS);
}

LANES_INLINE lanes stresses_settled(lanes mean, lanes to, unsigned shift) {
  const lanes one = lanes_all(1);
  return lanes_add(mean, longs_round(longs_sub(longs_mul(to, one), longs_mul(mean, one)), shift));
}

/* What c goes by comes to stand in strain; means come to stand in poles. */
LANES_INLINE void stresses_get_used(const stress_view *v, const stresses *s, lanes strain[3],
                                    lanes poles[HABIT_POLES][3]) {
  const int32_t *from = &v->habits->mean[0].uu;
  lanes low[4], high[4];
  records_take(from, HABIT_WORDS, s->of, low);
  records_take(from + 2, HABIT_WORDS, s->of, high);
  const lanes means[HABIT_POLES][3] = {{low[0], low[1], low[2]}, {low[3], high[2], high[3]}};
  LONGS_UNROLLED
  for (int pole = 0; pole < HABIT_POLES; ++pole) {
    LONGS_UNROLLED
    for (int n = 0; n < 3; ++n)
      strain[n] = poles[pole][n] = stresses_settled(means[pole][n], strain[n], v->habit_shift);
  }
}

/* Where a strain stands in the table, as place_of() has it; 0 where it is large. */
LANES_INLINE int stresses_place(stresses *s, const lanes strain[3]) {
  const lanes zero = lanes_all(0);
  const lanes one = lanes_all(STRAIN_ONE);
  const lanes large = lanes_max(lanes_size(strain[2]), lanes_max(lanes_size(strain[0]), lanes_size(strain[1])));
  if (lanes_bits(lanes_above(large, lanes_all(1 << STRESSES_STRAIN))) != 0) return 0;
  const lanes x = lanes_asr(lanes_sub(strain[0], strain[1]), 1);
  const lanes y = lanes_asr(lanes_size(strain[2]), 1);
  const longs squared = longs_add(longs_mul(x, x), longs_mul(y, y));
  lanes m;
  const lanes_root root = lanes_rsqrt(squared, &m);
  const lane_mask same = longs_below(squared, 1);
  const lanes length = lanes_root_length(root, m);
  const lanes spread = lanes_pick(same, zero, length);
  const lanes largest = lanes_add(lanes_asr(lanes_add(strain[0], strain[1]), 1), spread);
  const lane_mask drawn = lanes_above(largest, zero);
  const longs stretched = longs_shl(longs_of(lanes_add(one, lanes_shl(lanes_keep(drawn, largest), 1))), STRAIN_BITS);
  const lanes_root stretch = lanes_rsqrt(stretched, &m);
  const lanes over = lanes_sub(lanes_root_length(stretch, m), one);
  const lanes six = lanes_add(lanes_shl(over, 2), lanes_shl(over, 1));
  s->level = lanes_keep(drawn, lanes_max(zero, lanes_min(six, one)));
  const lane_mask some = lanes_above(s->level, zero);
  /* 16 spread is below largest: nearly the same in all directions */
  const lane_mask near = lanes_above(lanes_asr(lanes_sub(largest, lanes_all(1)), 4), lanes_sub(spread, lanes_all(1)));
  const lanes part = lanes_add(lanes_asr(largest, 4), lanes_all(1));
  const lanes faded = lanes_ratio(lanes_keep(near, lanes_shl(spread, 4)), STRAIN_BITS - 4, part);
  s->apart = lanes_keep(some, lanes_pick(near, faded, one));
  s->fades = lanes_bits(lanes_both(some, near)) != 0;
  const lanes at = lanes_keep(lanes_above(s->apart, zero), lanes_direction(x, y));
  const lanes row = lanes_min(lanes_asr(at, STRAIN_BITS), lanes_all(FABRIC_ROWS - 3));
  s->share = lanes_sub(at, lanes_shl(row, STRAIN_BITS));
  lanes_store(s->row, row);
  return 1;
}

LANES_INLINE lanes stresses_between(lanes a, lanes b, lanes share) {
  return lanes_add(a, lanes_share(lanes_sub(b, a), share));
}

/* Over all directions; entries are not below zero. */
LANES_INLINE void stresses_mean(const int32_t *table, const uint32_t of[LANES], lanes mean[FABRIC_ENTRIES]) {
  lanes rows[5][4];
  uint32_t at[LANES];
  for (uint32_t row = 0; row < 5; ++row) {
    for (uint32_t n = 0; n < (uint32_t)LANES; ++n) at[n] = of[n] + FABRIC_ENTRIES * (1 + row);
    records_take(table, 1, at, rows[row]);
  }
  LONGS_UNROLLED
  for (int n = 0; n < FABRIC_ENTRIES; ++n) {
    const longs ends = longs_add(longs_of(rows[0][n]), longs_of(rows[4][n]));
    const longs inner = longs_add(longs_add(longs_of(rows[1][n]), longs_of(rows[2][n])), longs_of(rows[3][n]));
    mean[n] = longs_round(longs_add(ends, longs_shl(inner, 1)), 3);
  }
}

LANES_INLINE void stresses_stiffness(const stress_view *v, const stresses *s, lanes c[FABRIC_ENTRIES]) {
  const int32_t *table = v->fabrics->stretch[0];
  uint32_t of[LANES], from[LANES], to[LANES];
  lanes rest[4], low[4], high[4], mean[4];
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) {
    of[n] = FABRIC_WORDS * v->cloth[s->of[n]];
    from[n] = of[n] + FABRIC_ENTRIES * (1u + (uint32_t)s->row[n]);
    to[n] = from[n] + FABRIC_ENTRIES;
  }
  records_take(table, 1, of, rest);
  records_take(table, 1, from, low);
  records_take(table, 1, to, high);
  LONGS_UNROLLED
  for (int n = 0; n < FABRIC_ENTRIES; ++n) mean[n] = rest[n];
  if (s->fades) stresses_mean(table, of, mean);
  LONGS_UNROLLED
  for (int n = 0; n < FABRIC_ENTRIES; ++n) {
    const lanes row = stresses_between(low[n], high[n], s->share);
    const lane_mask whole = lanes_above(s->apart, lanes_all(STRAIN_ONE - 1));
    const lanes drawn = s->fades ? lanes_pick(whole, row, stresses_between(mean[n], row, s->apart)) : row;
    c[n] = stresses_between(rest[n], drawn, s->level);
  }
}

LANES_INLINE void stresses_keep(int32_t *to, uint32_t words, const lanes word[3]) {
  int32_t kept[3][LANES];
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) lanes_store(kept[n], word[n]);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n)
    for (uint32_t k = 0; k < 3; ++k) to[words * n + k] = kept[k][n];
}

LANES_INLINE int stresses_group(const stress_view *v, uint32_t first) {
  stresses s;
  lanes c[4], poles[HABIT_POLES][3];
  if (!stresses_strain(v, first, &s)) return 0;
  lanes strain[3] = {s.uu, s.vv, s.uv};
  stresses_get_used(v, &s, strain, poles);
  if (!stresses_place(&s, strain)) return 0;
  stresses_stiffness(v, &s, c);
  const longs shear = longs_mul(c[3], s.uv);
  longs far = longs_farther(longs_all(0), shear);
  const lanes uu = pulls_sum(&far, c[0], s.uu, c[1], s.vv, STRAIN_BITS);
  const lanes vv = pulls_sum(&far, c[1], s.uu, c[2], s.vv, STRAIN_BITS);
  const lanes stress[3] = {uu, vv, longs_round(shear, STRAIN_BITS)};
  if (longs_any_from(far, STRESSES_STRESS)) return 0;
  records_put(v->row[first].c, c);
  stresses_keep(&v->stress[first].uu, sizeof(tensor) / 4, stress);
  for (uint32_t pole = 0; pole < HABIT_POLES; ++pole)
    stresses_keep(&v->habits[first].mean[pole].uu, HABIT_WORDS, poles[pole]);
  return 1;
}

/* As many as none of LANES is left to the scalar code. */
LANES_INLINE uint32_t stresses_run(const stress_view *v, uint32_t first, uint32_t end) {
  uint32_t at = first;
  if (v->habit_shift == 0) return 0; /* c goes by the strain of the moment: patch tests */
  while (end - at >= (uint32_t)LANES && stresses_group(v, at)) at += (uint32_t)LANES;
  return at - first;
}
#endif

#endif
