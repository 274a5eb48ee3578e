/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/woven/spring_tear.c, which measures what is found here exactly. Finds links that may be
 * over their threshold. */
#ifndef FRAY_SIMD_TEAR_SCAN_LANES_INL_H
#define FRAY_SIMD_TEAR_SCAN_LANES_INL_H

#include "rt/simd/link_terms.h"
#include "rt/simd/spring_lanes.inl.h"

typedef struct {
  const int32_t *x, *y, *z;
  const link_class *classes;
  int32_t stretch; /* 1 + the least threshold, Q12, rounded down */
  uint32_t *over;  /* bit n: spring n of the group may be over */
} tear_scan_lanes_view;

LANES_INLINE void tear_scan_lanes_pairs(const void *view, const spring_lanes *p) {
  const tear_scan_lanes_view *s = (const tear_scan_lanes_view *)view;
  const int32_t *const at[3] = {s->x, s->y, s->z};
  lanes hi[3];
  LANES_UNROLL_3
  for (int n = 0; n < 3; ++n) {
    const lanes d = lanes_sub(spring_lanes_load_j(p, at[n]), spring_lanes_load_i(p, at[n]));
    hi[n] = lanes_clamp(lanes_asr(d, LINK_SHIFT), LINK_HI_MAX);
  }
  /* three components rounded down make a length at most two units too short */
  const lanes rest = lanes_asr(spring_lanes_class(p, &s->classes->rest, LINK_CLASS_WORDS), LINK_SHIFT);
  const lanes limit = lanes_sub(lanes_asr(lanes_mul(rest, lanes_set(s->stretch)), 12), lanes_set(2));
  const lanes known = lanes_min(lanes_max(limit, lanes_set(0)), lanes_set(LINK_HI_MAX - 1));
  *s->over = mask_bits(lanes_greater(lanes_dot(hi, hi), lanes_mul(known, known)));
}

/* The first of rows first..end-1 that may be stretched by more than tear_min, Q16, or `end`. */
LANES_INLINE uint32_t tear_scan_lanes_run(link_view s, int32_t tear_min, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first <= end);
  const spring_rows rows = {s.i, s.j, s.kind};
  uint32_t over = 0;
  const tear_scan_lanes_view view = {s.x, s.y, s.z, s.classes, (65536 + tear_min) >> 4, &over};
  for (uint32_t row = first; row < end; row += LANES) {
    const uint32_t count = end - row < (uint32_t)LANES ? end - row : (uint32_t)LANES;
    over = 0;
    if (count == (uint32_t)LANES)
      spring_lanes_group(&rows, row, LANES, 1, tear_scan_lanes_pairs, &view);
    else
      spring_lanes_group(&rows, row, count, 0, tear_scan_lanes_pairs, &view);
    over &= mask_bits(mask_first(count));
    if (over != 0) return row + (uint32_t)__builtin_ctz(over);
  }
  return end;
}

#endif
