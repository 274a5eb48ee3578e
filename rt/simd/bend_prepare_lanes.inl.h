/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/membrane/bend_prepare.c, same order of operations. Per-tick constants of bending hinges,
 * LANES at a time. Groups with a triangle without area, or a value that would be clamped, are left to the
 * scalar code. */
#ifndef FRAY_SIMD_BEND_PREPARE_LANES_INL_H
#define FRAY_SIMD_BEND_PREPARE_LANES_INL_H

#include "rt/simd/bend_force_lanes.inl.h"
#include "rt/simd/material_direction_lanes.inl.h"
#include "rt/simd/membrane_force_lanes.inl.h"

#ifdef LANES_HAVE_64
enum { BEND_PREPARE_LANES_FAR = 54, BEND_PREPARE_LANES_DIRECTION = 36, BEND_PREPARE_LANES_STIFF = 30 };

typedef struct {
  uint32_t id[4][LANES];
  lanes side[3], to1[3], to2[3];
  lane_mask unsound;
  lanes64 far; /* sums that are rounded by 24 */
  lanes out[BEND_FORCE_LANES_CONSTANTS];
} bend_prepare_lanes;

LANES_INLINE void bend_prepare_lanes_load(const hinge_view *v, uint32_t first, uint32_t count,
                                          bend_prepare_lanes *s) {
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n)
    for (uint32_t k = 0; k < 4; ++k) s->id[k][n] = v->hinges[first + (n < count ? n : 0)].vertex[k];
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    s->side[n] = lanes_shl(lanes_difference(v->at[n], s->id[2], s->id[3], HINGE_REACH / 16), 4);
    s->to1[n] = lanes_shl(lanes_difference(v->at[n], s->id[3], s->id[0], HINGE_REACH / 16), 4);
    s->to2[n] = lanes_shl(lanes_difference(v->at[n], s->id[3], s->id[1], HINGE_REACH / 16), 4);
  }
}

LANES_INLINE lanes bend_prepare_lanes_mul_q24(bend_prepare_lanes *s, lanes a, lanes b) {
  const lanes64 product = lanes64_mul(a, b);
  s->far = lanes64_or_size(s->far, product);
  return lanes64_round(product, 24);
}

LANES_INLINE lanes bend_prepare_lanes_foot(const lanes from_end[3], const lanes side[3], lanes squared) {
  const lanes along = lanes64_round(lanes64_dot(from_end, side), 28);
  const lanes ratio = lanes_copy_sign(lanes_ratio(lanes_abs(along), 24, squared), along);
  return lanes_clamp(ratio, 2 * (1 << 24));
}

/* The direction of the edge at rest in *direction, Q28 of 0..2; returns 0 where an edge has no length or
 * one that exceeds 32 bits. */
LANES_INLINE int bend_prepare_lanes_direction(const hinge_view *v, const bend_prepare_lanes *s,
                                              lanes *direction) {
  const lanes u = lanes_asr(lanes_sub(lanes_gather(v->u, s->id[3]), lanes_gather(v->u, s->id[2])), 8);
  const lanes w = lanes_asr(lanes_sub(lanes_gather(v->v, s->id[3]), lanes_gather(v->v, s->id[2])), 8);
  const lanes64 x = lanes64_sub(lanes64_mul(u, u), lanes64_mul(w, w));
  const lanes64 y = lanes64_shl(lanes64_mul_u(lanes_abs(u), lanes_abs(w)), 1);
  if (lanes64_any_beyond(lanes64_or_size(lanes64_or_size(lanes64_set(0), x), y),
                         BEND_PREPARE_LANES_DIRECTION))
    return 0;
  const lanes cosine = lanes64_round(x, 6);
  const lanes half = lanes_copy_sign(lanes_asr(lanes_abs(cosine), 1), cosine);
  const lanes up = lanes_asr(lanes64_round(y, 6), 1);
  if (mask_bits(lanes_greater(lanes_set(1), lanes_max(lanes_abs(half), up))) != 0) return 0;
  *direction = lanes_asr(lanes_material_direction(half, up), 1);
  return 1;
}

/* The two rows of the material table on both sides of a direction: 2 MATERIAL_CURVES words. */
LANES_INLINE void bend_prepare_lanes_rows(const hinge_view *v, uint32_t first, uint32_t count, lanes row,
                                          lanes bend[2 * MATERIAL_CURVES]) {
  const int32_t *from = v->materials->bend[0];
  int32_t rows[LANES];
  uint32_t of[LANES];
  lanes word[4];
  lanes_store(rows, row);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n)
    of[n] = MATERIAL_WORDS * bend_hinge_material(&v->hinges[first + (n < count ? n : 0)]) +
            MATERIAL_CURVES * (uint32_t)rows[n];
  LANES_UNROLL
  for (int n = 0; n < 2 * MATERIAL_CURVES; n += 4) {
    const int k = n + 4 > 2 * MATERIAL_CURVES ? 2 * MATERIAL_CURVES - 4 : n;
    record_lanes_load(from + k, 1, of, word);
    LANES_UNROLL
    for (int m = 0; m < 4; ++m) bend[k + m] = word[m];
  }
}

LANES_INLINE int bend_prepare_lanes_stiffness(const hinge_view *v, uint32_t first, uint32_t count,
                                              lanes shape, bend_prepare_lanes *s) {
  const unsigned shift = (unsigned)v->constants->bend_shift;
  lanes direction, bend[2 * MATERIAL_CURVES];
  lanes64 far = lanes64_set(0);
  if (!bend_prepare_lanes_direction(v, s, &direction)) return 0;
  const lane_mask beyond = lanes_greater(direction, lanes_set(STRAIN_ONE - 1));
  const lanes row = lanes_or_zero(beyond, lanes_set(1));
  const lanes turned = lanes_sub(direction, lanes_or_zero(beyond, lanes_set(STRAIN_ONE)));
  bend_prepare_lanes_rows(v, first, count, row, bend);
  LANES_UNROLL
  for (int n = 0; n < MATERIAL_CURVES; ++n) {
    const lanes more =
        lanes64_round(lanes64_mul(lanes_sub(bend[MATERIAL_CURVES + n], bend[n]), turned), STRAIN_BITS);
    const lanes64 stiff = lanes64_mul(bend_prepare_lanes_mul_q24(s, lanes_add(bend[n], more), shape),
                                      lanes_set(v->constants->bend_gain));
    far = lanes64_or(far, stiff);
    s->out[BEND_FORCE_LANES_STIFF + n] = lanes64_round(stiff, shift);
  }
  return shift > 32 || !lanes64_any_beyond(far, BEND_PREPARE_LANES_STIFF + shift);
}

LANES_INLINE int bend_prepare_lanes_group(const hinge_view *v, uint32_t first, uint32_t count) {
  bend_prepare_lanes s;
  lanes area1[3], area2[3], unused[3];
  int32_t out[BEND_FORCE_LANES_CONSTANTS][LANES];
  bend_prepare_lanes_load(v, first, count, &s);
  s.far = lanes64_set(0);
  s.unsound = mask_none();
  lanes64_cross(s.side, s.to1, 28, area1);
  lanes64_cross(s.to2, s.side, 28, area2);
  const lanes length1 = lanes_direction(area1, HINGE_MIN, unused, &s.unsound);
  const lanes length2 = lanes_direction(area2, HINGE_MIN, unused, &s.unsound);
  const lanes edge = lanes_direction(s.side, HINGE_MIN, unused, &s.unsound);
  if (mask_bits(s.unsound) != 0) return 0;
  const lanes squared = lanes64_round(lanes64_dot(s.side, s.side), 28);
  const lanes areas = lanes_add(length1, length2);
  if (!bend_prepare_lanes_stiffness(v, first, count, lanes_ratio(squared, 24, areas), &s)) return 0;
  s.out[BEND_FORCE_LANES_CURVATURE] =
      bend_prepare_lanes_mul_q24(&s, lanes_ratio(edge, 24, areas), lanes_set(v->constants->curve_gain));
  if (lanes64_any_beyond(s.far, BEND_PREPARE_LANES_FAR)) return 0;
  s.out[BEND_FORCE_LANES_HEIGHT] = lanes_ratio(edge, 16, length1);
  s.out[BEND_FORCE_LANES_HEIGHT + 1] = lanes_ratio(edge, 16, length2);
  s.out[BEND_FORCE_LANES_FOOT] = bend_prepare_lanes_foot(s.to1, s.side, squared);
  s.out[BEND_FORCE_LANES_FOOT + 1] = bend_prepare_lanes_foot(s.to2, s.side, squared);
  LANES_UNROLL
  for (int k = 0; k < BEND_FORCE_LANES_CONSTANTS; ++k) lanes_store(out[k], s.out[k]);
  for (uint32_t n = 0; n < count; ++n) {
    bend_hinge *c = &v->hinges[first + n];
    for (uint32_t k = 0; k < MATERIAL_CURVES; ++k) c->stiffness[k] = out[BEND_FORCE_LANES_STIFF + k][n];
    c->curvature_scale = out[BEND_FORCE_LANES_CURVATURE][n];
    for (uint32_t k = 0; k < 2; ++k) {
      c->height[k] = out[BEND_FORCE_LANES_HEIGHT + k][n];
      c->foot[k] = out[BEND_FORCE_LANES_FOOT + k][n];
    }
  }
  return 1;
}

LANES_RUN_GROUPS(bend_prepare_lanes_run, hinge_view, bend_prepare_lanes_group)
#endif

#endif
