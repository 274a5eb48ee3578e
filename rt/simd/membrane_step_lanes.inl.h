/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/membrane/membrane_step.c. Vertices in an elastic step, LANES at a time. */
#ifndef FRAY_SIMD_MEMBRANE_STEP_LANES_INL_H
#define FRAY_SIMD_MEMBRANE_STEP_LANES_INL_H

#include "rt/simd/membrane_view.h"
#include "rt/simd/record_lanes.inl.h"

#ifdef LANES_HAVE_64
enum { MEMBRANE_STEP_LANES_FAR = 51 }; /* bits of impulse times inverse mass, before it is rounded */

typedef struct {
  lanes speed, low, at;
} membrane_step_lanes_axis;

LANES_INLINE lanes membrane_step_lanes_dragged(const step_view *k, lanes speed) {
  const lanes64 lost =
      lanes64_add(lanes64_mul_u(lanes_abs(speed), lanes_set(k->drag)), lanes64_set(k->dither));
  const lanes least = lanes64_low(lanes64_shr(lost, 30));
  return lanes_sub(speed, lanes_copy_sign(least, speed));
}

LANES_INLINE void membrane_step_lanes_move(const step_view *k, int axis, lanes pulled, uint32_t first,
                                           lanes at, membrane_step_lanes_axis *a) {
  const lanes pushed = lanes_add(lanes_load(k->v[axis] + first), pulled);
  const lanes held = lanes_clamp(pushed, FX_SPEED_MAX);
  a->speed = lanes_add(membrane_step_lanes_dragged(k, held), lanes_set(k->gravity[axis]));
  const lanes64 way = lanes64_add(lanes64_mul(a->speed, lanes_set(k->part)),
                                  lanes64_from(lanes_load(k->low[axis] + first)));
  a->low = lanes_and(lanes64_low(way), lanes_set(INT32_MAX));
  a->at = lanes_add(at, lanes64_low(lanes64_shr(way, ELASTIC_LOW_BITS)));
}

LANES_INLINE int membrane_step_lanes_group(const step_view *k, uint32_t first) {
  const unsigned bits = ELASTIC_IMPULSE_BITS + ELASTIC_INVERSE_BITS - FX_VELOCITY_BITS;
  const lanes inverse = lanes_load(k->inverse + first);
  uint32_t id[LANES];
  lanes sum[4], at[4], pulled[3];
  membrane_step_lanes_axis a[3];
  lanes64 far = lanes64_set(0);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) id[n] = first + n;
  record_lanes_load(&k->sum->x, 4, id, sum);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    const lanes64 product = lanes64_mul(sum[n], inverse);
    far = lanes64_or_size(far, product);
    pulled[n] = lanes64_round(product, bits);
  }
  if (lanes64_any_beyond(far, MEMBRANE_STEP_LANES_FAR)) return 0;
  record_lanes_load(k->place->at, 4, id, at);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    membrane_step_lanes_move(k, n, pulled[n], first, at[n], &a[n]);
    lanes_store(k->v[n] + first, a[n].speed);
    lanes_store(k->low[n] + first, a[n].low);
    at[n] = a[n].at;
  }
  at[3] =
      lanes_add(lanes_asr(a[0].low, ELASTIC_LOW_BITS - ELASTIC_DIFFERENCE_MORE),
                lanes_add(lanes_shl(lanes_asr(a[1].low, ELASTIC_LOW_BITS - ELASTIC_DIFFERENCE_MORE), 8),
                          lanes_shl(lanes_asr(a[2].low, ELASTIC_LOW_BITS - ELASTIC_DIFFERENCE_MORE), 16)));
  record_lanes_store(k->place[first].at, at);
  return 1;
}

LANES_RUN_WHOLE_GROUPS(membrane_step_lanes_run, step_view, membrane_step_lanes_group)
#endif

#endif
