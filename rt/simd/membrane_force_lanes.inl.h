/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/membrane/membrane_force.c, same order of operations. Forces of triangles, LANES at a time,
 * by either law; groups in which a value would be clamped, or to which membrane/strain_law.h applies, are
 * left to the scalar code. Most values stay in low words of 64-bit lanes, as they are multiplied next. */
#ifndef FRAY_SIMD_MEMBRANE_FORCE_LANES_INL_H
#define FRAY_SIMD_MEMBRANE_FORCE_LANES_INL_H

#include "rt/simd/corotational_lanes.inl.h"
#include "rt/simd/lanes64.inl.h"
#include "rt/simd/membrane_view.h"
#include "rt/simd/record_lanes.inl.h"
#include "rt/simd/spring_lanes.inl.h"

#ifdef LANES_HAVE_64
enum {
  MEMBRANE_FORCE_LANES_AXIS = 54,
  MEMBRANE_FORCE_LANES_STRESS = 58,
  MEMBRANE_FORCE_LANES_CORNER = 56
}; /* bits of sums before they are rounded */

/* A group of triangles. */
typedef struct {
  uint32_t id[3][LANES];
  lanes64 u[3], v[3];     /* axes, Q28: low words, as those below */
  lanes64 r[4];           /* u1, u2, v1, v2 */
  lanes g_uu, g_vv, g_uv; /* strain */
  lanes64 uu, vv, uv;     /* impulse of stress */
  lanes kept[3];          /* for the next step */
  lanes64 far_axis, far_stress, far_corner;
} membrane_force_lanes;

/* to - from by axis, with the fraction bits of elastic positions. */
LANES_INLINE void membrane_force_lanes_difference(const lanes from[4], const lanes to[4], lanes way[3]) {
  /* 4 is added to each byte, so that no byte borrows from the next */
  const lanes below = lanes_sub(lanes_add(to[3], lanes_set(0x040404)), from[3]);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    const lanes whole = lanes_clamp(lanes_sub(to[n], from[n]), ELASTIC_DIFFERENCE_MAX);
    const lanes more = lanes_and(n == 0 ? below : lanes_asr(below, 8u * (unsigned)n), lanes_set(7));
    way[n] = lanes_add(lanes_shl(whole, ELASTIC_DIFFERENCE_MORE), lanes_sub(more, lanes_set(4)));
  }
}

/* a b + c d, rounded; its size goes into `far`. */
LANES_INLINE lanes lanes_dot2(lanes64 *far, lanes a, lanes b, lanes c, lanes d, unsigned bits) {
  const lanes64 sum = lanes64_add(lanes64_mul(a, b), lanes64_mul(c, d));
  *far = lanes64_or_size(*far, sum);
  return lanes64_round(sum, bits);
}

LANES_INLINE void membrane_force_lanes_load(const force_view *v, uint32_t first, uint32_t count,
                                            membrane_force_lanes *s, lanes c[4]) {
  uint32_t of[LANES];
  lanes at[3][4], d1[3], d2[3], r[4];
  const trimesh_triangle *triangle = &v->triangle[first];
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) {
    of[n] = n < count ? n : 0;
    for (uint32_t k = 0; k < 3; ++k) s->id[k][n] = triangle[of[n]].v[k];
  }
  LANES_UNROLL
  for (int k = 0; k < 3; ++k) record_lanes_load(v->place->at, 4, s->id[k], at[k]);
  record_lanes_load(&v->weights[first].u1, 4, of, r);
  record_lanes_load(v->gains[first].c, 4, of, c);
  membrane_force_lanes_difference(at[0], at[1], d1);
  membrane_force_lanes_difference(at[0], at[2], d2);
  LANES_UNROLL
  for (int n = 0; n < 4; ++n) s->r[n] = lanes64_words(r[n]);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    const unsigned bits = TRIMESH_WEIGHT_BITS + FX_VELOCITY_BITS + ELASTIC_DIFFERENCE_MORE - STRAIN_BITS;
    const lanes64 one = lanes64_words(d1[n]);
    const lanes64 two = lanes64_words(d2[n]);
    s->u[n] = lanes64_dot2(&s->far_axis, one, s->r[0], two, s->r[1], bits);
    s->v[n] = lanes64_dot2(&s->far_axis, one, s->r[2], two, s->r[3], bits);
  }
}

LANES_INLINE void membrane_force_lanes_strain(membrane_force_lanes *s) {
  const lanes64 one = lanes64_set((int64_t)1 << 2 * STRAIN_BITS);
  const lanes64 uu = lanes64_sub(lanes64_dot_low(s->u, s->u), one);
  const lanes64 vv = lanes64_sub(lanes64_dot_low(s->v, s->v), one);
  const lanes64 uv = lanes64_dot_low(s->u, s->v);
  s->far_stress = lanes64_or_size(lanes64_or_size(lanes64_or_size(s->far_stress, uu), vv), uv);
  s->g_uu = lanes64_round(uu, STRAIN_BITS + 1);
  s->g_vv = lanes64_round(vv, STRAIN_BITS + 1);
  s->g_uv = lanes64_round(uv, STRAIN_BITS);
}

LANES_INLINE void membrane_force_lanes_stress(membrane_force_lanes *s, const lanes c[4]) {
  const lanes64 c1 = lanes64_words(c[1]);
  const lanes64 uu = lanes64_words(s->g_uu);
  const lanes64 vv = lanes64_words(s->g_vv);
  const lanes64 shear = lanes64_mul(c[3], s->g_uv);
  s->uu = lanes64_dot2(&s->far_stress, lanes64_words(c[0]), uu, c1, vv, STRAIN_BITS);
  s->vv = lanes64_dot2(&s->far_stress, c1, uu, lanes64_words(c[2]), vv, STRAIN_BITS);
  s->far_stress = lanes64_or_size(s->far_stress, shear);
  s->uv = lanes64_rounded(shear, STRAIN_BITS);
}

LANES_INLINE lanes64 membrane_force_lanes_damped(const int32_t *last, uint32_t count, lanes now) {
  uint32_t of[LANES];
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) of[n] = n < count ? n : 0;
  const lanes before = count == (uint32_t)LANES ? lanes_load(last) : lanes_gather(last, of);
  return lanes64_words(lanes_add(now, lanes_round(lanes_sub(now, before), STRESS_RISE_BITS)));
}

/* Returns 0 where a stress is larger than is kept. */
LANES_INLINE int membrane_force_lanes_damp(const force_view *v, uint32_t first, uint32_t count,
                                           membrane_force_lanes *s) {
  lanes64 *const stress[3] = {&s->uu, &s->vv, &s->uv};
  lane_mask beyond = lanes_not_equal(lanes_set(0), lanes_set(0));
  if (v->last == NULL) return 1;
  LANES_UNROLL
  for (uint32_t k = 0; k < 3; ++k) {
    const lanes now = lanes64_low(*stress[k]);
    s->kept[k] = lanes_clamp(now, STRESS_KEPT_MAX);
    beyond = mask_or(beyond, lanes_not_equal(now, s->kept[k]));
    const int32_t *last = v->last + k * v->last_stride + first;
    if (v->has_last != 0) *stress[k] = membrane_force_lanes_damped(last, count, now);
  }
  return mask_bits(beyond) == 0;
}

LANES_INLINE void membrane_force_lanes_keep(const force_view *v, uint32_t first, uint32_t count,
                                            const membrane_force_lanes *s) {
  int32_t words[LANES];
  if (v->last == NULL) return;
  for (uint32_t k = 0; k < 3; ++k) {
    int32_t *const last = v->last + k * v->last_stride + first;
    lanes_store(count == (uint32_t)LANES ? last : words, s->kept[k]);
    for (uint32_t n = 0; count != (uint32_t)LANES && n < count; ++n) last[n] = words[n];
  }
}

/* Returns 0 where a value would be clamped. */
LANES_INLINE int membrane_force_lanes_impulses(membrane_force_lanes *s, lanes one[4], lanes two[4]) {
  const unsigned bits = TRIMESH_WEIGHT_BITS + FORCE_MORE_BITS;
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    const lanes64 p1 = lanes64_dot2(&s->far_stress, s->uu, s->u[n], s->uv, s->v[n], STRAIN_BITS);
    const lanes64 p2 = lanes64_dot2(&s->far_stress, s->uv, s->u[n], s->vv, s->v[n], STRAIN_BITS);
    const lanes64 j1 = lanes64_dot2(&s->far_corner, p1, s->r[0], p2, s->r[2], bits);
    const lanes64 j2 = lanes64_dot2(&s->far_corner, p1, s->r[1], p2, s->r[3], bits);
    one[n] = lanes_clamp(lanes64_low(j1), FORCE_MAX);
    two[n] = lanes_clamp(lanes64_low(j2), FORCE_MAX);
  }
  one[3] = two[3] = lanes_set(0);
  return !(lanes64_any_beyond(s->far_axis, MEMBRANE_FORCE_LANES_AXIS) ||
           lanes64_any_beyond(s->far_stress, MEMBRANE_FORCE_LANES_STRESS) ||
           lanes64_any_beyond(s->far_corner, MEMBRANE_FORCE_LANES_CORNER));
}

LANES_INLINE void membrane_force_lanes_add(const force_view *v, const membrane_force_lanes *s, uint32_t count,
                                           lanes one[4], lanes two[4]) {
  lanes both[4];
  LANES_UNROLL
  for (int n = 0; n < 4; ++n) {
    both[n] = lanes_add(one[n], two[n]);
    one[n] = lanes_sub(lanes_set(0), one[n]);
    two[n] = lanes_sub(lanes_set(0), two[n]);
  }
  record_lanes_add(&v->sum->x, s->id[0], count, both);
  record_lanes_add(&v->sum->x, s->id[1], count, one);
  record_lanes_add(&v->sum->x, s->id[2], count, two);
}

LANES_INLINE int membrane_force_lanes_group(const force_view *v, uint32_t first, uint32_t count) {
  membrane_force_lanes s;
  uint32_t of[LANES];
  lanes c[4], one[4], two[4];
  s.far_axis = s.far_stress = s.far_corner = lanes64_set(0);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) of[n] = first + (n < count ? n : 0);
  membrane_force_lanes_load(v, first, count, &s, c);
  membrane_force_lanes_strain(&s);
  membrane_force_lanes_stress(&s, c);
  if (!membrane_force_lanes_damp(v, first, count, &s)) return 0;
  const int is_within = membrane_force_lanes_impulses(&s, one, two);
  const lanes largest = lanes_add(lanes_max(s.g_uu, s.g_vv), lanes_asr(lanes_abs(s.g_uv), 1));
  const lane_mask beyond = lanes_greater(largest, lanes_gather(v->strain_threshold, of));
  if (!is_within || mask_bits(beyond) != 0) return 0;
  membrane_force_lanes_keep(v, first, count, &s);
  membrane_force_lanes_add(v, &s, count, one, two);
  return 1;
}

LANES_RUN_GROUPS(membrane_force_lanes_run, force_view, membrane_force_lanes_group)

#if FRAY_CRACKS
LANES_INLINE int corotational_force_lanes_group(const force_view *v, uint32_t first, uint32_t count) {
  membrane_force_lanes s;
  lanes64 stress[3];
  lanes c[4], one[4], two[4];
  s.far_axis = s.far_stress = s.far_corner = lanes64_set(0);
  membrane_force_lanes_load(v, first, count, &s, c);
  if (lanes64_any_beyond(s.far_axis, MEMBRANE_FORCE_LANES_AXIS)) return 0;
  const corotational_lanes_c square = corotational_lanes_c_of(s.u, s.v);
  if (corotational_lanes_is_far(&square)) return 0;
  corotational_lanes_stress(c, &square, stress);
  s.uu = stress[0];
  s.vv = stress[1];
  s.uv = stress[2];
  if (!membrane_force_lanes_damp(v, first, count, &s)) return 0;
  if (!membrane_force_lanes_impulses(&s, one, two)) return 0;
  membrane_force_lanes_keep(v, first, count, &s);
  membrane_force_lanes_add(v, &s, count, one, two);
  return 1;
}

LANES_RUN_GROUPS(corotational_force_lanes_run, force_view, corotational_force_lanes_group)
#endif
#endif

#endif
