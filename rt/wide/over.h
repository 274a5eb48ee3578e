/* SPDX-License-Identifier: Apache-2.0 */
/* Finds links that may be over their threshold; stage/tear.c measures those exactly. */
#ifndef FRAY_WIDE_OVER_H
#define FRAY_WIDE_OVER_H

#include "rt/wide/link.h"
#include "rt/wide/pairs.h"

typedef struct {
  const int32_t *x, *y, *z;
  const link_class *classes;
  int32_t stretch;      /* 1 + the least threshold, Q12, rounded down */
  uint32_t *over;       /* bit n: row n of those that were taken */
} over_view;

LANES_INLINE void over_pairs(const void *view, const pairs *p) {
  const over_view *s = (const over_view *)view;
  const int32_t *const at[3] = {s->x, s->y, s->z};
  lanes hi[3];
  LANES_UNROLLED
  for (int n = 0; n < 3; ++n) {
    const lanes d = lanes_sub(pairs_fetch_j(p, at[n]), pairs_fetch_i(p, at[n]));
    hi[n] = lanes_clamp(lanes_asr(d, LINK_SHIFT), LINK_HI_MAX);
  }
  /* a direction rounded down in three components is at most two units too short */
  const lanes rest = lanes_asr(pairs_class(p, &s->classes->rest, LINK_CLASS_WORDS), LINK_SHIFT);
  const lanes limit =
      lanes_sub(lanes_asr(lanes_mul(rest, lanes_all(s->stretch)), 12), lanes_all(2));
  const lanes known = lanes_min(lanes_max(limit, lanes_all(0)), lanes_all(LINK_HI_MAX - 1));
  *s->over = lanes_bits(lanes_above(lanes_dot(hi, hi), lanes_mul(known, known)));
}

/* The first of rows first..end-1 that may be stretched by more than tear_min, Q16, or `end`. */
LANES_INLINE uint32_t over_next(link_view s, int32_t tear_min, uint32_t first, uint32_t end) {
  const pair_rows rows = {s.i, s.j, s.kind};
  uint32_t over = 0;
  const over_view view = {s.x, s.y, s.z, s.classes, (65536 + tear_min) >> 4, &over};
  for (uint32_t row = first; row < end; row += LANES) {
    const uint32_t count = end - row < (uint32_t)LANES ? end - row : (uint32_t)LANES;
    over = 0;
    if (count == (uint32_t)LANES)
      pairs_some(&rows, row, LANES, 1, over_pairs, &view);
    else
      pairs_some(&rows, row, count, 0, over_pairs, &view);
    over &= lanes_bits(lanes_first(count));
    if (over != 0) return row + (uint32_t)__builtin_ctz(over);
  }
  return end;
}

#endif
