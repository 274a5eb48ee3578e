/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/membrane/bend_force.c, same order of operations. The five passes of a bending step, LANES
 * at a time; the last elements, fewer than LANES, are left to the scalar code, and groups in which a value
 * would be clamped beyond 32 bits. */
#ifndef FRAY_SIMD_BEND_FORCE_LANES_INL_H
#define FRAY_SIMD_BEND_FORCE_LANES_INL_H

#include "rt/simd/membrane_view.h"
#include "rt/simd/record_lanes.inl.h"

#ifdef LANES_HAVE_64
enum { BEND_FORCE_LANES_BITS = 30 }; /* of what is rounded */

LANES_INLINE void bend_force_lanes_row(uint32_t first, uint32_t at[LANES]) {
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) at[n] = first + n;
}
LANES_INLINE lanes bend_force_lanes_mul30(lanes a, lanes b) { return lanes64_round(lanes64_mul(a, b), 30); }
LANES_INLINE const uint32_t *bend_force_lanes_ids(const bend_view *v, uint32_t column, uint32_t first) {
  return (const uint32_t *)(const void *)(bend_fold(v, column) + first);
}
/* Stores to the sides at these places. */
LANES_INLINE void bend_force_lanes_scatter(const bend_view *v, const uint32_t *place, lanes m) {
  int32_t *const to = v->moment->side;
  int32_t words[LANES];
  lanes_store(words, m);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) to[place[n]] = words[n];
}

LANES_INLINE int bend_normals_lanes_group(const bend_view *v, uint32_t first, uint32_t count) {
  uint32_t id[3][LANES];
  lanes at[3][4], d1[3], d2[3], normal[3], unit[4], m;
  if (count < (uint32_t)LANES) return 0;
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n)
    for (uint32_t k = 0; k < 3; ++k) id[k][n] = v->triangle[first + n].v[k];
  LANES_UNROLL
  for (int k = 0; k < 3; ++k) record_lanes_load(v->place->at, 4, id[k], at[k]);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    d1[n] = lanes_clamp(lanes_sub(at[1][n], at[0][n]), BEND_REACH);
    d2[n] = lanes_clamp(lanes_sub(at[2][n], at[0][n]), BEND_REACH);
  }
  lanes64_cross(d1, d2, 28, normal);
  const lanes64 squared = lanes64_dot(normal, normal);
  const lanes least = lanes_load(bend_plate(v, PLATE_AREA_MIN) + first);
  const lane_mask small = lanes_greater(least, lanes64_low(lanes64_shr(squared, BEND_AREA_DOWN)));
  if (mask_bits(mask_or(small, lanes64_less(squared, BEND_FLAT))) != 0) return 0;
  const lanes_root root = lanes_rsqrt(squared, &m);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) unit[n] = lanes_unit(root, normal[n]);
  unit[3] = lanes_add(lanes_and(lanes_asr(root.inverse, 1), lanes_set(INT32_MAX & ~BEND_EXPONENT)), root.h);
  record_lanes_store(v->normal[first].n, unit);
  return 1;
}

LANES_INLINE lanes64 bend_force_lanes_term(lanes64 sum, lanes64 x, int32_t more) {
  return lanes64_add_words(lanes64_rounded(lanes64_mul_low(sum, x), 30), lanes64_set(more));
}
/* 2 asin(s), by low words. */
LANES_INLINE lanes bend_force_lanes_angle(lanes64 s) {
  const lanes64 x = bend_force_lanes_term(s, s, 0);
  lanes64 sum = bend_force_lanes_term(lanes64_set(BEND_ASIN_4), x, BEND_ASIN_3);
  sum = bend_force_lanes_term(sum, x, BEND_ASIN_2);
  sum = bend_force_lanes_term(sum, x, BEND_ASIN_1);
  sum = bend_force_lanes_term(sum, x, BEND_ASIN_0);
  return lanes64_low(bend_force_lanes_term(s, sum, 0));
}

LANES_INLINE void bend_force_lanes_normal(const bend_view *v, const uint32_t *place, lanes normal[4]) {
  uint32_t of[LANES];
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) of[n] = place[n] / 4u;
  record_lanes_load(v->normal->n, 4, of, normal);
}

LANES_INLINE int bend_folds_lanes_group(const bend_view *v, uint32_t first, uint32_t count) {
  lanes n1[4], n2[4], base[4], opposite[4], up[3], off[3];
  if (count < (uint32_t)LANES) return 0;
  const uint32_t *const one = bend_force_lanes_ids(v, FOLD_FIRST, first);
  const uint32_t *const two = bend_force_lanes_ids(v, FOLD_SECOND, first);
  bend_force_lanes_normal(v, one, n1);
  bend_force_lanes_normal(v, two, n2);
  record_lanes_load(v->place->at, 4, bend_force_lanes_ids(v, FOLD_BASE, first), base);
  record_lanes_load(v->place->at, 4, bend_force_lanes_ids(v, FOLD_OPPOSITE, first), opposite);
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    up[n] = lanes_clamp(lanes_sub(opposite[n], base[n]), BEND_REACH);
    off[n] = lanes_asr(lanes_sub(n1[n], n2[n]), 1);
  }
  const lanes64 squared = lanes64_dot(off, off);
  const lanes size = bend_force_lanes_angle(lanes64_root_length(squared));
  const lane_mask folded =
      mask_and_not(lanes_greater(lanes_min(n1[3], n2[3]), lanes_set(0)), lanes64_less(squared, 1));
  const lane_mask down = lanes64_less(lanes64_dot(up, n1), 1 << 29); /* rounded, it is not above zero */
  const lanes angle = lanes_or_zero(folded, lanes_select(down, lanes_sub(lanes_set(0), size), size));
  const lanes held = bend_force_lanes_mul30(angle, lanes_load(bend_fold(v, FOLD_HOLD) + first));
  const lanes part = lanes_add(bend_force_lanes_mul30(held, lanes_load(bend_fold(v, FOLD_SHARE) + first)),
                               lanes_load(bend_fold(v, FOLD_OFFSET) + first));
  bend_force_lanes_scatter(v, one, part);
  bend_force_lanes_scatter(v, two, lanes_sub(held, part));
  return 1;
}

LANES_INLINE lanes bend_force_lanes_moment(lanes h0, lanes h1, lanes h2, const lanes angle[3]) {
  const lanes h[3] = {h0, h1, h2};
  return lanes64_round(lanes64_dot(h, angle), 30);
}

LANES_INLINE int bend_moments_lanes_group(const bend_view *v, uint32_t first, uint32_t count) {
  uint32_t at[LANES];
  lanes angle[4], h[6], m[4];
  if (count < (uint32_t)LANES) return 0;
  bend_force_lanes_row(first, at);
  record_lanes_load(v->moment->side, 4, at, angle);
  LANES_UNROLL
  for (int n = 0; n < 6; ++n) h[n] = lanes_load(bend_plate(v, (uint32_t)n) + first);
  m[0] = bend_force_lanes_moment(h[PLATE_H00], h[PLATE_H01], h[PLATE_H02], angle);
  m[1] = bend_force_lanes_moment(h[PLATE_H01], h[PLATE_H11], h[PLATE_H12], angle);
  m[2] = bend_force_lanes_moment(h[PLATE_H02], h[PLATE_H12], h[PLATE_H22], angle);
  m[3] = angle[3];
  record_lanes_store(v->moment[first].side, m);
  return 1;
}

LANES_INLINE int bend_joints_lanes_group(const bend_view *v, uint32_t first, uint32_t count) {
  if (count < (uint32_t)LANES) return 0;
  const uint32_t *const one = bend_force_lanes_ids(v, FOLD_FIRST, first);
  const uint32_t *const two = bend_force_lanes_ids(v, FOLD_SECOND, first);
  const lanes m2 = lanes_gather(v->moment->side, two);
  const lanes apart = lanes_sub(lanes_gather(v->moment->side, one), m2);
  const lanes shared =
      lanes_add(m2, bend_force_lanes_mul30(apart, lanes_load(bend_fold(v, FOLD_SHARE) + first)));
  const lanes m = bend_force_lanes_mul30(shared, lanes_load(bend_fold(v, FOLD_HOLD) + first));
  if (v->is_measure == 0) {
    int32_t *const offset = bend_fold(v, FOLD_OFFSET) + first;
    const lanes64 back = lanes64_mul(apart, lanes_load(bend_fold(v, FOLD_RATE) + first));
    const lanes64 far = lanes64_or_size(lanes64_set(0), back);
    if (lanes64_any_beyond(far, FOLD_RATE_BITS + BEND_FORCE_LANES_BITS)) return 0;
    lanes_store(offset, lanes_clamp(lanes_sub(lanes_load(offset), lanes64_round(back, FOLD_RATE_BITS)),
                                    BEND_OFFSET_MAX));
  }
  bend_force_lanes_scatter(v, one, m);
  bend_force_lanes_scatter(v, two, m);
  return 1;
}

/* Along the normal, of the corner opposite e. */
LANES_INLINE lanes bend_force_lanes_corner(const lanes e[3], const lanes torque[3], lanes per_area,
                                           lanes down, lanes64 *far_dot, lanes64 *far_impulse) {
  const lanes64 dot = lanes64_dot(e, torque);
  *far_dot = lanes64_or_size(*far_dot, dot);
  const lanes along = lanes64_round(dot, 28);
  const lanes64 product = lanes64_shr_by(lanes64_mul_u(lanes_abs(along), per_area), down);
  const lanes64 impulse = lanes64_shr(lanes64_add(product, lanes64_set(1)), 1);
  *far_impulse = lanes64_or(*far_impulse, impulse);
  const lanes size = lanes_min(lanes64_low(impulse), lanes_set(BEND_MAX));
  return lanes_sub(lanes_set(0), lanes_copy_sign(size, along));
}

LANES_INLINE int bend_corners_lanes_group(const bend_view *v, uint32_t first, uint32_t count) {
  uint32_t at[LANES], id[3][LANES];
  lanes place[3][4], e[3][3], m[4], per_length[3], torque[3], normal[4], none[4], one[4], two[4];
  lanes64 far = lanes64_set(0);
  lanes64 far_torque = lanes64_set(0);
  lanes64 far_dot = lanes64_set(0);
  lanes64 far_impulse = lanes64_set(0);
  if (count < (uint32_t)LANES || v->impulse_shift < -8 || v->impulse_shift > 31) return 0;
  bend_force_lanes_row(first, at);
  record_lanes_load(v->moment->side, 4, at, m);
  record_lanes_load(v->normal->n, 4, at, normal);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n)
    for (uint32_t k = 0; k < 3; ++k) id[k][n] = v->triangle[first + n].v[k];
  LANES_UNROLL
  for (int k = 0; k < 3; ++k) {
    const lanes64 product =
        lanes64_mul(m[k], lanes_load(bend_plate(v, PLATE_PER_LENGTH_0 + (uint32_t)k) + first));
    far = lanes64_or_size(far, product);
    per_length[k] = lanes64_round(product, BEND_PER_LENGTH_LESS);
    record_lanes_load(v->place->at, 4, id[k], place[k]);
  }
  if (lanes64_any_beyond(far, BEND_PER_LENGTH_LESS + BEND_FORCE_LANES_BITS)) return 0;
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    const lanes d2 = lanes_clamp(lanes_sub(place[2][n], place[0][n]), BEND_REACH);
    e[2][n] = lanes_clamp(lanes_sub(place[1][n], place[0][n]), BEND_REACH);
    e[0][n] = lanes_sub(d2, e[2][n]);
    e[1][n] = lanes_sub(lanes_set(0), d2);
    const lanes along[3] = {e[0][n], e[1][n], e[2][n]};
    const lanes64 sum = lanes64_dot(along, per_length);
    far_torque = lanes64_or_size(far_torque, sum);
    torque[n] = lanes64_round(sum, BEND_TORQUE_LESS);
  }
  if (lanes64_any_beyond(far_torque, BEND_TORQUE_LESS + BEND_FORCE_LANES_BITS)) return 0;
  const lanes per_area = lanes_and(normal[3], lanes_set(~BEND_EXPONENT));
  const lanes down =
      lanes_add(lanes_and(normal[3], lanes_set(BEND_EXPONENT)), lanes_set(v->impulse_shift - 1));
  if (mask_bits(lanes_greater(lanes_set(0), down)) != 0) return 0;
  const lanes j1 = bend_force_lanes_corner(e[1], torque, per_area, down, &far_dot, &far_impulse);
  const lanes j2 = bend_force_lanes_corner(e[2], torque, per_area, down, &far_dot, &far_impulse);
  if (lanes64_any_beyond(far_dot, 28 + BEND_FORCE_LANES_BITS) || lanes64_any_beyond(far_impulse, 31))
    return 0;
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    one[n] = lanes_scale_unit(normal[n], j1);
    two[n] = lanes_scale_unit(normal[n], j2);
    none[n] = lanes_sub(lanes_set(0), lanes_add(one[n], two[n]));
  }
  none[3] = one[3] = two[3] = lanes_set(0);
  record_lanes_add(&v->sum->x, id[0], count, none);
  record_lanes_add(&v->sum->x, id[1], count, one);
  record_lanes_add(&v->sum->x, id[2], count, two);
  return 1;
}

LANES_RUN_GROUPS(bend_normals_lanes_run, bend_view, bend_normals_lanes_group)
LANES_RUN_GROUPS(bend_folds_lanes_run, bend_view, bend_folds_lanes_group)
LANES_RUN_GROUPS(bend_moments_lanes_run, bend_view, bend_moments_lanes_group)
LANES_RUN_GROUPS(bend_joints_lanes_run, bend_view, bend_joints_lanes_group)
LANES_RUN_GROUPS(bend_corners_lanes_run, bend_view, bend_corners_lanes_group)
#endif

#endif
