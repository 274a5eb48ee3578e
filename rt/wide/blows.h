/* SPDX-License-Identifier: Apache-2.0 */
/* Wind on triangles, LANES at a time: stage/blow.c says what is computed, in the same order. Faster air and
 * greater impulses, whose sums might have to be held to a bound, are left to the scalar code. */
#ifndef FRAY_WIDE_BLOWS_H
#define FRAY_WIDE_BLOWS_H

#include "rt/model/element.h"
#include "rt/wide/folds.h"
#include "rt/wide/pulls.h"

#ifdef LANES_LONGS
enum {
  BLOWS_SPEED = 1 << 28, /* of vertices, so that three of them fit */
  BLOWS_WIND = 400000000, /* so that the square of its length, Q28, fits 31 bits */
  BLOWS_FAR = 58,
  BLOWS_BITS = 22 /* 16 impulses at a vertex stay below BLOW_MAX */
};

typedef struct {
  lanes normal[3], wind[3];
  lanes area;
  lane_mask flat;
  int is_far;
} blows;

/* What has no length has no direction: 0. */
LANES_INLINE lanes blows_unit(const lanes v[3], lanes unit[3], lane_mask *nothing) {
  const longs squared = longs_squared(v);
  lanes m;
  const lanes_root root = lanes_rsqrt(squared, &m);
  *nothing = longs_below(squared, 1);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) unit[n] = lanes_unit(root, v[n]);
  return lanes_root_length(root, m);
}

LANES_INLINE lanes blows_air(blows *s, int32_t wind, const int32_t *speed, uint32_t id[3][LANES]) {
  const lanes a = lanes_of(speed, id[0]);
  const lanes b = lanes_of(speed, id[1]);
  const lanes c = lanes_of(speed, id[2]);
  const lanes fastest = lanes_max(lanes_size(a), lanes_max(lanes_size(b), lanes_size(c)));
  const lanes sum = lanes_add(lanes_add(a, b), c);
  const lanes third = lanes_sub(longs_high(longs_mul(sum, lanes_all(0x55555556))), lanes_sign(sum));
  const lanes air = lanes_sub(lanes_all(wind), third);
  const lane_mask far = lanes_either(lanes_above(fastest, lanes_all(BLOWS_SPEED)),
                                     lanes_above(lanes_size(air), lanes_all(BLOWS_WIND)));
  s->is_far |= lanes_bits(far) != 0;
  return air;
}

/* Of air of this speed, Q28; not below zero. */
LANES_INLINE lanes blows_share(blows *s, lanes speed, int32_t gain, unsigned shift) {
  const longs pressed = longs_mul(longs_round(longs_mul(speed, speed), 28), s->area);
  const longs impulse = longs_mul(longs_round(pressed, 28), lanes_all(gain));
  const longs whole = longs_shr(impulse, shift);
  s->is_far |= longs_any_from(pressed, BLOWS_FAR) || longs_any_from(whole, BLOWS_BITS) || longs_any_from(whole, 32);
  return longs_round(impulse, shift);
}

LANES_INLINE void blows_fetch(const blow_view *v, blows *s, uint32_t id[3][LANES]) {
  lanes d1[3], d2[3], product[3];
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    d1[n] = records_way(v->at[n], id[0], id[1], ELEMENT_REACH);
    d2[n] = records_way(v->at[n], id[0], id[2], ELEMENT_REACH);
    s->wind[n] = blows_air(s, v->cloths->wind[n], v->speed[n], id);
  }
  longs_cross(d1, d2, FX_POSITION_BITS, product);
  s->area = blows_unit(product, s->normal, &s->flat);
}

LANES_INLINE int blows_group(const blow_view *v, uint32_t first, uint32_t count) {
  const cloth_params *c = v->cloths;
  const unsigned shift = (unsigned)c->wind_shift;
  uint32_t id[3][LANES];
  lanes j[4], along[3], way[3];
  lane_mask still;
  blows s;
  s.is_far = 0;
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n)
    for (uint32_t k = 0; k < 3; ++k) id[k][n] = v->triangle[first + (n < count ? n : 0)].v[k];
  blows_fetch(v, &s, id);
  const lanes across = longs_round(pulls_dot(s.wind, s.normal), 30);
  const lanes push = lanes_signed(blows_share(&s, lanes_size(across), c->wind_normal, shift), across);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) along[n] = lanes_sub(s.wind[n], lanes_scaled(s.normal[n], across));
  const lanes speed = blows_unit(along, way, &still);
  const lanes drawn = lanes_keep(lanes_without(lanes_above(lanes_all(1), lanes_all(0)), still),
                                 blows_share(&s, speed, c->wind_drag, shift));
  if (s.is_far) return 0;
  const lane_mask blown = lanes_without(lanes_above(lanes_all(1), lanes_all(0)), s.flat);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n)
    j[n] = lanes_keep(blown, lanes_add(lanes_scaled(s.normal[n], push), lanes_scaled(way[n], drawn)));
  j[3] = lanes_all(0);
  LONGS_UNROLLED
  for (int k = 0; k < 3; ++k) records_add(&v->sum->x, id[k], count, j);
  return 1;
}

RECORDS_GROUPS(blows_run, blow_view, blows_group)
#endif

#endif
