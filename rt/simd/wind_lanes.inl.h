/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/membrane/wind.c, same order of operations. Wind on triangles, LANES at a time. Groups
 * with faster air, larger impulses, whose sums might be clamped, or triangles so light that air would take
 * more than half of their speed, are left to the scalar code. */
#ifndef FRAY_SIMD_WIND_LANES_INL_H
#define FRAY_SIMD_WIND_LANES_INL_H

#include "rt/simd/membrane_force_lanes.inl.h"
#include "rt/state/deformation.h"

#ifdef LANES_HAVE_64
enum {
  WIND_LANES_SPEED = 1 << 28,  /* of a vertex: the sum of three fits */
  WIND_LANES_WIND = 400000000, /* so that the square of its length, Q28, fits 31 bits */
  WIND_LANES_FAR = 58,
  WIND_LANES_BITS = 22 /* 16 impulses at a vertex stay below BLOW_MAX */
};

typedef struct {
  lanes normal[3], wind[3];
  lanes area;      /* twice it, as the triangle is now */
  lanes rest_area;
  lanes unit;
  lane_mask flat;
  int is_far;
} wind_lanes;

LANES_INLINE lanes wind_lanes_relative(wind_lanes *s, int32_t wind, const int32_t *speed,
                                       uint32_t id[3][LANES]) {
  const lanes a = lanes_gather(speed, id[0]);
  const lanes b = lanes_gather(speed, id[1]);
  const lanes c = lanes_gather(speed, id[2]);
  const lanes fastest = lanes_max(lanes_abs(a), lanes_max(lanes_abs(b), lanes_abs(c)));
  const lanes sum = lanes_add(lanes_add(a, b), c);
  const lanes third = lanes_sub(lanes64_high(lanes64_mul(sum, lanes_set(0x55555556))), lanes_sign(sum));
  const lanes air = lanes_sub(lanes_set(wind), third);
  const lane_mask far = mask_or(lanes_greater(fastest, lanes_set(WIND_LANES_SPEED)),
                                lanes_greater(lanes_abs(air), lanes_set(WIND_LANES_WIND)));
  s->is_far |= mask_bits(far) != 0;
  return air;
}

/* The impulse of air of this speed, Q28 and not negative. */
LANES_INLINE lanes wind_lanes_impulse(wind_lanes *s, lanes speed, int32_t gain, unsigned shift) {
  const lanes64 pressed = lanes64_mul(lanes64_round(lanes64_mul(speed, speed), 28), s->area);
  const lanes64 impulse = lanes64_mul(lanes64_round(pressed, 28), lanes_set(gain));
  const lanes64 whole = lanes64_shr(impulse, shift);
  const lanes rounded = lanes64_round(impulse, shift);
  const lanes64 most = lanes64_shr(lanes64_mul(s->rest_area, speed), 1);
  s->is_far |= mask_bits(lanes64_negative(lanes64_sub(most, lanes64_mul(rounded, s->unit)))) != 0;
  s->is_far |= lanes64_any_beyond(pressed, WIND_LANES_FAR) || lanes64_any_beyond(whole, WIND_LANES_BITS) ||
               lanes64_any_beyond(whole, 32);
  return rounded;
}

LANES_INLINE void wind_lanes_fetch(const wind_view *v, wind_lanes *s, uint32_t id[3][LANES]) {
  lanes d1[3], d2[3], product[3];
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    d1[n] = lanes_difference(v->at[n], id[0], id[1], DEFORMATION_REACH);
    d2[n] = lanes_difference(v->at[n], id[0], id[2], DEFORMATION_REACH);
    s->wind[n] = wind_lanes_relative(s, v->constants->wind[n], v->speed[n], id);
  }
  lanes64_cross(d1, d2, FX_POSITION_BITS, product);
  s->flat = mask_none();
  s->area = lanes_direction(product, 1, s->normal, &s->flat);
}

LANES_INLINE int wind_lanes_group(const wind_view *v, uint32_t first, uint32_t count) {
  const membrane_params *c = v->constants;
  const unsigned shift = (unsigned)c->wind_shift;
  uint32_t id[3][LANES];
  int32_t area[LANES];
  lanes j[4], along[3], way[3];
  lane_mask still = mask_none();
  wind_lanes s;
  s.is_far = 0;
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n)
    for (uint32_t k = 0; k < 3; ++k) id[k][n] = v->triangle[first + (n < count ? n : 0)].v[k];
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) area[n] = (int32_t)v->area[first + (n < count ? n : 0)];
  s.rest_area = lanes_load(area);
  s.unit = lanes_set(c->mass_unit);
  wind_lanes_fetch(v, &s, id);
  const lanes across = lanes64_round(lanes64_dot(s.wind, s.normal), 30);
  const lanes push =
      lanes_copy_sign(wind_lanes_impulse(&s, lanes_abs(across), c->wind_normal, shift), across);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) along[n] = lanes_sub(s.wind[n], lanes_scale_unit(s.normal[n], across));
  const lanes speed = lanes_direction(along, 1, way, &still);
  const lanes drawn = lanes_or_zero(mask_and_not(lanes_greater(lanes_set(1), lanes_set(0)), still),
                                    wind_lanes_impulse(&s, speed, c->wind_drag, shift));
  if (s.is_far) return 0;
  const lane_mask blown = mask_and_not(lanes_greater(lanes_set(1), lanes_set(0)), s.flat);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n)
    j[n] = lanes_or_zero(blown,
                         lanes_add(lanes_scale_unit(s.normal[n], push), lanes_scale_unit(way[n], drawn)));
  j[3] = lanes_set(0);
  LANES_UNROLL
  for (int k = 0; k < 3; ++k) record_lanes_add(&v->sum->x, id[k], count, j);
  return 1;
}

LANES_RUN_GROUPS(wind_lanes_run, wind_view, wind_lanes_group)
#endif

#endif
