/* SPDX-License-Identifier: Apache-2.0 */
/* How stiff creases are in a tick, LANES at a time: stage/crease.c says what is computed, in the same
 * order. What has no area, or would have to be held to a bound, is left to the scalar code. */
#ifndef FRAY_WIDE_WEIGHS_H
#define FRAY_WIDE_WEIGHS_H

#include "rt/wide/direction.h"
#include "rt/wide/folds.h"
#include "rt/wide/pulls.h"

#ifdef LANES_LONGS
enum { WEIGHS_FAR = 54, WEIGHS_DIRECTION = 36, WEIGHS_STIFF = 30 };

typedef struct {
  uint32_t id[4][LANES];
  lanes side[3], to1[3], to2[3];
  lane_mask unsound;
  longs far; /* sums that are rounded by 24 */
  lanes out[FOLDS_CONSTANTS];
} weighs;

LANES_INLINE void weighs_fetch(const weigh_view *v, uint32_t first, uint32_t count, weighs *s) {
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n)
    for (uint32_t k = 0; k < 4; ++k) s->id[k][n] = v->creases[first + (n < count ? n : 0)].x[k];
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    s->side[n] = lanes_shl(records_way(v->at[n], s->id[2], s->id[3], HINGE_REACH / 16), 4);
    s->to1[n] = lanes_shl(records_way(v->at[n], s->id[3], s->id[0], HINGE_REACH / 16), 4);
    s->to2[n] = lanes_shl(records_way(v->at[n], s->id[3], s->id[1], HINGE_REACH / 16), 4);
  }
}

LANES_INLINE lanes weighs_length(weighs *s, const lanes v[3]) {
  const longs squared = longs_squared(v);
  lanes m;
  const lanes_root root = lanes_rsqrt(squared, &m);
  s->unsound = lanes_either(s->unsound, longs_below(squared, HINGE_LEAST));
  return lanes_root_length(root, m);
}

LANES_INLINE lanes weighs_times(weighs *s, lanes a, lanes b) {
  const longs product = longs_mul(a, b);
  s->far = longs_farther(s->far, product);
  return longs_round(product, 24);
}

LANES_INLINE lanes weighs_foot(const lanes from_end[3], const lanes side[3], lanes squared) {
  const lanes along = longs_round(pulls_dot(from_end, side), 28);
  const lanes ratio = lanes_signed(lanes_ratio(lanes_size(along), 24, squared), along);
  return lanes_clamp(ratio, 2 * (1 << 24));
}

/* Of sides at rest: Q28 of 0..2; 0 where one is too long for 32 bits, or nothing. */
LANES_INLINE int weighs_direction(const weigh_view *v, const weighs *s, lanes *direction) {
  const lanes u = lanes_asr(lanes_sub(lanes_of(v->u, s->id[3]), lanes_of(v->u, s->id[2])), 8);
  const lanes w = lanes_asr(lanes_sub(lanes_of(v->v, s->id[3]), lanes_of(v->v, s->id[2])), 8);
  const longs x = longs_sub(longs_mul(u, u), longs_mul(w, w));
  const longs y = longs_shl(longs_mul_u(lanes_size(u), lanes_size(w)), 1);
  if (longs_any_from(longs_farther(longs_farther(longs_all(0), x), y), WEIGHS_DIRECTION)) return 0;
  const lanes cosine = longs_round(x, 6);
  const lanes half = lanes_signed(lanes_asr(lanes_size(cosine), 1), cosine);
  const lanes up = lanes_asr(longs_round(y, 6), 1);
  if (lanes_bits(lanes_above(lanes_all(1), lanes_max(lanes_size(half), up))) != 0) return 0;
  *direction = lanes_asr(lanes_direction(half, up), 1);
  return 1;
}

/* Ten words of a fabric's table, the two rows between which a direction lies. */
LANES_INLINE void weighs_rows(const weigh_view *v, uint32_t first, uint32_t count, lanes row,
                              lanes bend[2 * FABRIC_CURVES]) {
  const int32_t *from = v->fabrics->bend[0];
  int32_t rows[LANES];
  uint32_t of[LANES];
  lanes word[4];
  lanes_store(rows, row);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n)
    of[n] = FABRIC_WORDS * (uint32_t)v->creases[first + (n < count ? n : 0)].reach +
            FABRIC_CURVES * (uint32_t)rows[n];
  LONGS_UNROLLED
  for (int n = 0; n < 2 * FABRIC_CURVES; n += 4) {
    const int k = n + 4 > 2 * FABRIC_CURVES ? 2 * FABRIC_CURVES - 4 : n;
    records_take(from + k, 1, of, word);
    LONGS_UNROLLED
    for (int m = 0; m < 4; ++m) bend[k + m] = word[m];
  }
}

LANES_INLINE int weighs_stiffness(const weigh_view *v, uint32_t first, uint32_t count, lanes shape, weighs *s) {
  const unsigned shift = (unsigned)v->cloths->bend_shift;
  lanes direction, bend[2 * FABRIC_CURVES];
  longs far = longs_all(0);
  if (!weighs_direction(v, s, &direction)) return 0;
  const lane_mask beyond = lanes_above(direction, lanes_all(STRAIN_ONE - 1));
  const lanes row = lanes_keep(beyond, lanes_all(1));
  const lanes turned = lanes_sub(direction, lanes_keep(beyond, lanes_all(STRAIN_ONE)));
  weighs_rows(v, first, count, row, bend);
  LONGS_UNROLLED
  for (int n = 0; n < FABRIC_CURVES; ++n) {
    const lanes more = longs_round(longs_mul(lanes_sub(bend[FABRIC_CURVES + n], bend[n]), turned), STRAIN_BITS);
    const longs stiff = longs_mul(weighs_times(s, lanes_add(bend[n], more), shape), lanes_all(v->cloths->bend_gain));
    far = longs_or(far, stiff);
    s->out[FOLDS_STIFF + n] = longs_round(stiff, shift);
  }
  return shift > 32 || !longs_any_from(far, WEIGHS_STIFF + shift);
}

LANES_INLINE int weighs_group(const weigh_view *v, uint32_t first, uint32_t count) {
  weighs s;
  lanes area1[3], area2[3];
  int32_t out[FOLDS_CONSTANTS][LANES];
  weighs_fetch(v, first, count, &s);
  s.far = longs_all(0);
  s.unsound = lanes_above(lanes_all(0), lanes_all(0));
  longs_cross(s.side, s.to1, 28, area1);
  longs_cross(s.to2, s.side, 28, area2);
  const lanes length1 = weighs_length(&s, area1);
  const lanes length2 = weighs_length(&s, area2);
  const lanes edge = weighs_length(&s, s.side);
  if (lanes_bits(s.unsound) != 0) return 0;
  const lanes squared = longs_round(longs_squared(s.side), 28);
  const lanes areas = lanes_add(length1, length2);
  if (!weighs_stiffness(v, first, count, lanes_ratio(squared, 24, areas), &s)) return 0;
  s.out[FOLDS_REACH] = weighs_times(&s, lanes_ratio(edge, 24, areas), lanes_all(v->cloths->curve_gain));
  if (longs_any_from(s.far, WEIGHS_FAR)) return 0;
  s.out[FOLDS_HEIGHT] = lanes_ratio(edge, 16, length1);
  s.out[FOLDS_HEIGHT + 1] = lanes_ratio(edge, 16, length2);
  s.out[FOLDS_FOOT] = weighs_foot(s.to1, s.side, squared);
  s.out[FOLDS_FOOT + 1] = weighs_foot(s.to2, s.side, squared);
  LONGS_UNROLLED
  for (int k = 0; k < FOLDS_CONSTANTS; ++k) lanes_store(out[k], s.out[k]);
  for (uint32_t n = 0; n < count; ++n) {
    crease *c = &v->creases[first + n];
    for (uint32_t k = 0; k < FABRIC_CURVES; ++k) c->stiff[k] = out[FOLDS_STIFF + k][n];
    c->reach = out[FOLDS_REACH][n];
    for (uint32_t k = 0; k < 2; ++k) {
      c->height[k] = out[FOLDS_HEIGHT + k][n];
      c->foot[k] = out[FOLDS_FOOT + k][n];
    }
  }
  return 1;
}

RECORDS_GROUPS(weighs_run, weigh_view, weighs_group)
#endif

#endif
