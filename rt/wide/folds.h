/* SPDX-License-Identifier: Apache-2.0 */
/* Creases that resist folding, LANES at a time: stage/fold.c says what is computed, in the same order. */
#ifndef FRAY_WIDE_FOLDS_H
#define FRAY_WIDE_FOLDS_H

#include "rt/wide/inner.h"
#include "rt/wide/records.h"

#ifdef LANES_LONGS
enum { FOLDS_FAR = 54, FOLDS_WORDS = sizeof(crease) / 4, FOLDS_CONSTANTS = FOLDS_WORDS - 4 };

/* Words of a crease behind its vertices. */
enum { FOLDS_STIFF = 0, FOLDS_REACH = FABRIC_CURVES, FOLDS_HEIGHT, FOLDS_FOOT = FOLDS_HEIGHT + 2 };

typedef struct {
  uint32_t id[4][LANES];
  lanes side[3], to1[3], to2[3];
  lanes word[FOLDS_CONSTANTS];
  lane_mask flat; /* no area or no side to speak of, or no fold at all */
  longs far;
} folds;

LANES_INLINE void folds_fetch(const fold_view *v, uint32_t first, uint32_t count, folds *s) {
  const int32_t *from = v->creases->stiff;
  uint32_t of[LANES];
  lanes at[4][4], word[4];
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) {
    of[n] = first + (n < count ? n : 0);
    for (uint32_t k = 0; k < 4; ++k) s->id[k][n] = v->creases[of[n]].x[k];
  }
  LONGS_UNROLLED
  for (int k = 0; k < 4; ++k) records_take(v->place->at, 4, s->id[k], at[k]);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    s->side[n] = lanes_clamp(lanes_sub(at[3][n], at[2][n]), HINGE_REACH);
    s->to1[n] = lanes_clamp(lanes_sub(at[0][n], at[3][n]), HINGE_REACH);
    s->to2[n] = lanes_clamp(lanes_sub(at[1][n], at[3][n]), HINGE_REACH);
  }
  LONGS_UNROLLED
  for (int n = 0; n < FOLDS_CONSTANTS; n += 4) {
    const int k = n + 4 > FOLDS_CONSTANTS ? FOLDS_CONSTANTS - 4 : n;
    records_take(from + k, FOLDS_WORDS, of, word);
    LONGS_UNROLLED
    for (int m = 0; m < 4; ++m) s->word[k + m] = word[m];
  }
}

/* Takes away what has no length to speak of. */
LANES_INLINE void folds_unit(folds *s, const lanes v[3], lanes unit[3]) {
  const longs squared = longs_squared(v);
  lanes m;
  const lanes_root root = lanes_rsqrt(squared, &m);
  s->flat = lanes_either(s->flat, longs_below(squared, HINGE_LEAST));
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) unit[n] = lanes_unit(root, v[n]);
}

LANES_INLINE lanes folds_half(folds *s, const lanes n1[3], const lanes n2[3]) {
  lanes off[3], m;
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) off[n] = lanes_asr(lanes_sub(n1[n], n2[n]), 1);
  const longs squared = longs_squared(off);
  const lanes_root root = lanes_rsqrt(squared, &m);
  s->flat = lanes_either(s->flat, longs_below(squared, 1));
  return lanes_root_length(root, m);
}

LANES_INLINE lanes folds_stiffness(folds *s, lanes half) {
  const longs place = longs_mul(half, s->word[FOLDS_REACH]);
  const lanes whole = longs_low(longs_shr(place, 28));
  const lanes step = longs_low(longs_shr(longs_shr(place, 30), 22));
  const lanes within = lanes_and(whole, lanes_all(0xFFFFFF));
  lanes from = s->word[FOLDS_STIFF];
  lanes to = s->word[FOLDS_STIFF + 1];
  LONGS_UNROLLED
  for (int n = 1; n < FABRIC_CURVES; ++n) {
    const lane_mask beyond = lanes_above(step, lanes_all(n - 1));
    from = lanes_pick(beyond, s->word[FOLDS_STIFF + n], from);
    to = lanes_pick(beyond, s->word[FOLDS_STIFF + (n + 1 < FABRIC_CURVES ? n + 1 : n)], to);
  }
  return lanes_add(from, longs_round(longs_mul(lanes_sub(to, from), within), 24));
}

LANES_INLINE void folds_opposite(folds *s, lanes turning, lanes height, const lanes normal[3], lanes j[3]) {
  const longs size = longs_mul(turning, height);
  const lanes held = lanes_clamp(longs_round(size, 24), FOLD_MAX);
  s->far = longs_farther(s->far, size);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) j[n] = lanes_scaled(normal[n], held);
}

LANES_INLINE int folds_group(const fold_view *v, uint32_t first, uint32_t count) {
  folds s;
  lanes area1[3], area2[3], n1[3], n2[3], j1[4], j2[4], j3[4], back[4];
  folds_fetch(v, first, count, &s);
  s.far = longs_all(0);
  s.flat = longs_below(longs_squared(s.side), HINGE_LEAST);
  longs_cross(s.side, s.to1, 28, area1);
  longs_cross(s.to2, s.side, 28, area2);
  folds_unit(&s, area1, n1);
  folds_unit(&s, area2, n2);
  const lanes half = folds_half(&s, n1, n2);
  const lanes size = longs_round(longs_mul(folds_stiffness(&s, half), half), 30);
  const longs up = longs_add(longs_add(longs_mul(s.to2[0], n1[0]), longs_mul(s.to2[1], n1[1])),
                             longs_mul(s.to2[2], n1[2]));
  const lane_mask down = longs_below(up, 1 << 29); /* rounded, it is not above zero */
  const lanes turning = lanes_pick(down, size, lanes_sub(lanes_all(0), size));
  folds_opposite(&s, turning, s.word[FOLDS_HEIGHT], n1, j1);
  folds_opposite(&s, turning, s.word[FOLDS_HEIGHT + 1], n2, j2);
  if (longs_any_from(s.far, FOLDS_FAR)) return 0;
  const lane_mask bent = lanes_without(lanes_above(lanes_all(1), lanes_all(0)), s.flat);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    j1[n] = lanes_keep(bent, j1[n]);
    j2[n] = lanes_keep(bent, j2[n]);
    j3[n] = lanes_add(longs_round(longs_mul(j1[n], s.word[FOLDS_FOOT]), 24),
                      longs_round(longs_mul(j2[n], s.word[FOLDS_FOOT + 1]), 24));
    back[n] = lanes_sub(lanes_all(0), lanes_add(lanes_add(j1[n], j2[n]), j3[n]));
  }
  j1[3] = j2[3] = j3[3] = back[3] = lanes_all(0);
  records_add(&v->sum->x, s.id[0], count, j1);
  records_add(&v->sum->x, s.id[1], count, j2);
  records_add(&v->sum->x, s.id[2], count, j3);
  records_add(&v->sum->x, s.id[3], count, back);
  return 1;
}

RECORDS_GROUPS(folds_run, fold_view, folds_group)
#endif

#endif
