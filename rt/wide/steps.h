/* SPDX-License-Identifier: Apache-2.0 */
/* Vertices in an inner step, LANES at a time: stage/inner.c says what is computed. */
#ifndef FRAY_WIDE_STEPS_H
#define FRAY_WIDE_STEPS_H

#include "rt/wide/inner.h"
#include "rt/wide/records.h"

#ifdef LANES_LONGS
enum { STEPS_FAR = 51 }; /* bits of what is pulled, before it is rounded */

typedef struct {
  lanes speed, low, at;
} steps_axis;

LANES_INLINE lanes steps_dragged(const inner_view *k, lanes speed) {
  const longs lost = longs_add(longs_mul_u(lanes_size(speed), lanes_all(k->drag)), longs_all(k->dither));
  const lanes least = longs_low(longs_shr(lost, 30));
  return lanes_sub(speed, lanes_signed(least, speed));
}

LANES_INLINE void steps_one(const inner_view *k, int axis, lanes pulled, uint32_t first, lanes at, steps_axis *a) {
  const lanes pushed = lanes_add(lanes_load(k->v[axis] + first), pulled);
  const lanes held = lanes_clamp(pushed, FX_SPEED_MAX);
  a->speed = lanes_add(steps_dragged(k, held), lanes_all(k->gravity[axis]));
  const longs way = longs_add(longs_mul(a->speed, lanes_all(k->part)), longs_of(lanes_load(k->low[axis] + first)));
  a->low = lanes_and(longs_low(way), lanes_all(INT32_MAX));
  a->at = lanes_add(at, longs_low(longs_shr(way, INNER_LOW_BITS)));
}

LANES_INLINE int steps_group(const inner_view *k, uint32_t first) {
  const unsigned bits = INNER_PULL_BITS + INNER_INVERSE_BITS - FX_VELOCITY_BITS;
  const lanes inverse = lanes_load(k->inverse + first);
  uint32_t id[LANES];
  lanes sum[4], at[4], pulled[3];
  steps_axis a[3];
  longs far = longs_all(0);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) id[n] = first + n;
  records_take(&k->sum->x, 4, id, sum);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    const longs product = longs_mul(sum[n], inverse);
    far = longs_farther(far, product);
    pulled[n] = longs_round(product, bits);
  }
  if (longs_any_from(far, STEPS_FAR)) return 0;
  records_take(k->place->at, 4, id, at);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    steps_one(k, n, pulled[n], first, at[n], &a[n]);
    lanes_store(k->v[n] + first, a[n].speed);
    lanes_store(k->low[n] + first, a[n].low);
    at[n] = a[n].at;
  }
  at[3] = lanes_add(lanes_asr(a[0].low, INNER_LOW_BITS - INNER_WAY_MORE),
                    lanes_add(lanes_shl(lanes_asr(a[1].low, INNER_LOW_BITS - INNER_WAY_MORE), 8),
                              lanes_shl(lanes_asr(a[2].low, INNER_LOW_BITS - INNER_WAY_MORE), 16)));
  records_put(k->place[first].at, at);
  return 1;
}

/* As many as none of LANES is left to the scalar code. */
LANES_INLINE uint32_t inner_steps(const inner_view *k, uint32_t first, uint32_t end) {
  uint32_t at = first;
  while (end - at >= (uint32_t)LANES && steps_group(k, at)) at += (uint32_t)LANES;
  return at - first;
}
#endif

#endif
