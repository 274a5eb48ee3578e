/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/membrane/bend_force.c, same order of operations. Forces of bending hinges, LANES at a
 * time. */
#ifndef FRAY_SIMD_BEND_FORCE_LANES_INL_H
#define FRAY_SIMD_BEND_FORCE_LANES_INL_H

#include "rt/simd/membrane_view.h"
#include "rt/simd/record_lanes.inl.h"

#ifdef LANES_HAVE_64
enum {
  BEND_FORCE_LANES_FAR = 54,
  BEND_FORCE_LANES_WORDS = sizeof(bend_hinge) / 4,
  BEND_FORCE_LANES_CONSTANTS = BEND_FORCE_LANES_WORDS - 4
};

/* Words of a bend_hinge after its vertices. */
enum {
  BEND_FORCE_LANES_STIFF = 0,
  BEND_FORCE_LANES_CURVATURE = MATERIAL_CURVES,
  BEND_FORCE_LANES_HEIGHT,
  BEND_FORCE_LANES_FOOT = BEND_FORCE_LANES_HEIGHT + 2
};

typedef struct {
  uint32_t id[4][LANES];
  lanes side[3], to1[3], to2[3];
  lanes word[BEND_FORCE_LANES_CONSTANTS];
  lane_mask flat; /* a triangle without area, an edge without length, or no angle */
  lanes64 far;
} bend_force_lanes;

LANES_INLINE void bend_force_lanes_load(const bend_view *v, uint32_t first, uint32_t count,
                                        bend_force_lanes *s) {
  const int32_t *from = v->hinges->stiffness;
  uint32_t of[LANES];
  lanes at[4][4], word[4];
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) {
    of[n] = first + (n < count ? n : 0);
    for (uint32_t k = 0; k < 4; ++k) s->id[k][n] = v->hinges[of[n]].vertex[k];
  }
  LANES_UNROLL
  for (int k = 0; k < 4; ++k) record_lanes_load(v->place->at, 4, s->id[k], at[k]);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    s->side[n] = lanes_clamp(lanes_sub(at[3][n], at[2][n]), HINGE_REACH);
    s->to1[n] = lanes_clamp(lanes_sub(at[0][n], at[3][n]), HINGE_REACH);
    s->to2[n] = lanes_clamp(lanes_sub(at[1][n], at[3][n]), HINGE_REACH);
  }
  LANES_UNROLL
  for (int n = 0; n < BEND_FORCE_LANES_CONSTANTS; n += 4) {
    const int k = n + 4 > BEND_FORCE_LANES_CONSTANTS ? BEND_FORCE_LANES_CONSTANTS - 4 : n;
    record_lanes_load(from + k, BEND_FORCE_LANES_WORDS, of, word);
    LANES_UNROLL
    for (int m = 0; m < 4; ++m) s->word[k + m] = word[m];
  }
}

LANES_INLINE lanes bend_force_lanes_half_angle(bend_force_lanes *s, const lanes n1[3], const lanes n2[3]) {
  lanes off[3], unused[3];
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) off[n] = lanes_asr(lanes_sub(n1[n], n2[n]), 1);
  return lanes_direction(off, 1, unused, &s->flat);
}

LANES_INLINE lanes bend_force_lanes_stiffness(bend_force_lanes *s, lanes half) {
  const lanes64 place = lanes64_mul(half, s->word[BEND_FORCE_LANES_CURVATURE]);
  const lanes whole = lanes64_low(lanes64_shr(place, 28));
  const lanes step = lanes64_low(lanes64_shr(lanes64_shr(place, 30), 22));
  const lanes within = lanes_and(whole, lanes_set(0xFFFFFF));
  lanes from = s->word[BEND_FORCE_LANES_STIFF];
  lanes to = s->word[BEND_FORCE_LANES_STIFF + 1];
  LANES_UNROLL
  for (int n = 1; n < MATERIAL_CURVES; ++n) {
    const lane_mask beyond = lanes_greater(step, lanes_set(n - 1));
    from = lanes_select(beyond, s->word[BEND_FORCE_LANES_STIFF + n], from);
    to = lanes_select(beyond, s->word[BEND_FORCE_LANES_STIFF + (n + 1 < MATERIAL_CURVES ? n + 1 : n)], to);
  }
  return lanes_add(from, lanes64_round(lanes64_mul(lanes_sub(to, from), within), 24));
}

LANES_INLINE void bend_force_lanes_impulse(bend_force_lanes *s, lanes turning, lanes height,
                                           const lanes normal[3], lanes j[3]) {
  const lanes64 size = lanes64_mul(turning, height);
  const lanes held = lanes_clamp(lanes64_round(size, 24), BEND_MAX);
  s->far = lanes64_or_size(s->far, size);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) j[n] = lanes_scale_unit(normal[n], held);
}

LANES_INLINE int bend_force_lanes_group(const bend_view *v, uint32_t first, uint32_t count) {
  bend_force_lanes s;
  lanes area1[3], area2[3], n1[3], n2[3], j1[4], j2[4], j3[4], back[4];
  bend_force_lanes_load(v, first, count, &s);
  s.far = lanes64_set(0);
  s.flat = lanes64_less(lanes64_dot(s.side, s.side), HINGE_MIN);
  lanes64_cross(s.side, s.to1, 28, area1);
  lanes64_cross(s.to2, s.side, 28, area2);
  (void)lanes_direction(area1, HINGE_MIN, n1, &s.flat);
  (void)lanes_direction(area2, HINGE_MIN, n2, &s.flat);
  const lanes half = bend_force_lanes_half_angle(&s, n1, n2);
  const lanes size = lanes64_round(lanes64_mul(bend_force_lanes_stiffness(&s, half), half), 30);
  const lanes64 up = lanes64_dot(s.to2, n1);
  const lane_mask down = lanes64_less(up, 1 << 29); /* rounded, it is not above zero */
  const lanes turning = lanes_select(down, size, lanes_sub(lanes_set(0), size));
  bend_force_lanes_impulse(&s, turning, s.word[BEND_FORCE_LANES_HEIGHT], n1, j1);
  bend_force_lanes_impulse(&s, turning, s.word[BEND_FORCE_LANES_HEIGHT + 1], n2, j2);
  if (lanes64_any_beyond(s.far, BEND_FORCE_LANES_FAR)) return 0;
  const lane_mask bent = mask_and_not(lanes_greater(lanes_set(1), lanes_set(0)), s.flat);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    j1[n] = lanes_or_zero(bent, j1[n]);
    j2[n] = lanes_or_zero(bent, j2[n]);
    j3[n] = lanes_add(lanes64_round(lanes64_mul(j1[n], s.word[BEND_FORCE_LANES_FOOT]), 24),
                      lanes64_round(lanes64_mul(j2[n], s.word[BEND_FORCE_LANES_FOOT + 1]), 24));
    back[n] = lanes_sub(lanes_set(0), lanes_add(lanes_add(j1[n], j2[n]), j3[n]));
  }
  j1[3] = j2[3] = j3[3] = back[3] = lanes_set(0);
  record_lanes_add(&v->sum->x, s.id[0], count, j1);
  record_lanes_add(&v->sum->x, s.id[1], count, j2);
  record_lanes_add(&v->sum->x, s.id[2], count, j3);
  record_lanes_add(&v->sum->x, s.id[3], count, back);
  return 1;
}

LANES_RUN_GROUPS(bend_force_lanes_run, bend_view, bend_force_lanes_group)
#endif

#endif
