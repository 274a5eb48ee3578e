/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twins: rt/membrane/bend_prepare.c and bend_stiffness.c, same order of operations. What bending
 * steps multiply by, LANES triangles at a time. Groups with a triangle without area, pressed together or
 * thin, or a value to be clamped, and the last ones, fewer than LANES, are left to the scalar code. */
#ifndef FRAY_SIMD_BEND_PREPARE_LANES_INL_H
#define FRAY_SIMD_BEND_PREPARE_LANES_INL_H

#include "rt/simd/membrane_view.h"
#include "rt/simd/record_lanes.inl.h"

#ifdef LANES_HAVE_64
enum { BEND_PREPARE_LANES_ENTRY = 55 };

/* C at the habit of the curvature. */
LANES_INLINE void bend_prepare_lanes_stiffness(const plate_view *v, uint32_t first, lanes c[3]) {
  int32_t words[6][LANES], part[LANES];
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) {
    const int32_t habit = v->states[first + n].habit[SMOOTHED_STRAIN_POLES - 1];
    const material_table *f = &v->materials[v->material[first + n]];
    const uint32_t step = (uint32_t)fx_min(habit >> BEND_HABIT_BITS, MATERIAL_CURVES - 1);
    const uint32_t next = step + 1u < MATERIAL_CURVES ? step + 1u : step;
    part[n] = habit & ((1 << BEND_HABIT_BITS) - 1);
    for (uint32_t k = 0; k < 3; ++k) {
      words[2 * k][n] = f->bend[k][step];
      words[2 * k + 1][n] = f->bend[k][next];
    }
  }
  LANES_UNROLL
  for (int k = 0; k < 3; ++k) {
    const lanes from = lanes_load(words[2 * k]);
    const lanes rise = lanes_sub(lanes_load(words[2 * k + 1]), from);
    c[k] = lanes_add(from, lanes64_round(lanes64_mul(rise, lanes_load(part)), BEND_HABIT_BITS));
  }
}

LANES_INLINE int bend_stiffness_lanes_group(const plate_view *v, uint32_t first, uint32_t count) {
  static const uint8_t rows[6] = {0, 1, 2, 0, 0, 1};
  static const uint8_t columns[6] = {0, 1, 2, 1, 2, 2};
  enum { WORDS = sizeof(bend_shape) / 4 };
  uint32_t at[LANES];
  lanes word[12], scaled[9], c[3], h[6];
  lanes64 far = lanes64_set(0);
  if (count < (uint32_t)LANES) return 0;
  const int32_t *const from = v->shapes->side[0];
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) at[n] = first + n;
  record_lanes_load(from, WORDS, at, word);
  record_lanes_load(from + 4, WORDS, at, word + 4);
  record_lanes_load(from + 6, WORDS, at, word + 8); /* 6 to 9 */
  word[8] = word[10];
  bend_prepare_lanes_stiffness(v, first, c);
  LANES_UNROLL
  for (int n = 0; n < 9; ++n) scaled[n] = lanes64_round(lanes64_mul(c[n % 3], word[n]), 27);
  LANES_UNROLL
  for (int n = 0; n < 6; ++n) {
    const lanes64 sum = lanes64_dot(scaled + 3 * rows[n], word + 3 * columns[n]);
    far = lanes64_or_size(far, sum);
    h[n] = lanes_clamp(lanes64_round(sum, 25), BEND_ENTRY_MAX);
  }
  if (lanes64_any_beyond(far, BEND_PREPARE_LANES_ENTRY)) return 0;
  LANES_UNROLL
  for (int n = 0; n < 6; ++n) lanes_store(v->plates + (uint32_t)n * v->stride + first, h[n]);
  return 1;
}

/* Whether one of them is drawn thin: bend_fade_by_height() of its heights. */
LANES_INLINE int bend_prepare_lanes_thin(const plate_view *v, uint32_t first, lanes normal,
                                         const lanes length[3]) {
  int32_t high[LANES], along[3][LANES];
  int32_t least = BEND_ONE;
  lanes_store(high, normal);
  LANES_UNROLL
  for (int k = 0; k < 3; ++k) lanes_store(along[k], length[k]);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n)
    for (uint32_t k = 0; k < 3; ++k)
      least = fx_min(least, bend_fade_by_height(&v->shapes[first + n], k, (uint32_t)high[n],
                                                (uint32_t)along[k][n]));
  return least != BEND_ONE;
}

LANES_INLINE int bend_geometry_lanes_group(const plate_view *v, uint32_t first, uint32_t count) {
  uint32_t id[3][LANES];
  lanes e[3][3], d2[3], normal[3], length[3], per_length[3], m;
  int is_short = 0;
  if (count < (uint32_t)LANES) return 0;
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n)
    for (uint32_t k = 0; k < 3; ++k) id[k][n] = v->triangle[first + n].v[k];
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    e[2][n] = lanes_shl(lanes_difference(v->at[n], id[0], id[1], BEND_REACH / 16), 4);
    d2[n] = lanes_shl(lanes_difference(v->at[n], id[0], id[2], BEND_REACH / 16), 4);
    e[0][n] = lanes_sub(d2[n], e[2][n]);
    e[1][n] = lanes_sub(lanes_set(0), d2[n]);
  }
  lanes64_cross(e[2], d2, 28, normal);
  const lanes64 squared = lanes64_dot(normal, normal);
  if (mask_bits(lanes64_less(squared, BEND_FLAT)) != 0) return 0;
  const lanes_root over = lanes_rsqrt(squared, &m);
  const lanes high = lanes_root_length(over, m);
  const lanes area = lanes_load((const int32_t *)(const void *)(v->area + first));
  const lanes pressed = lanes_asr(lanes_add(area, lanes_set(3)), 2); /* Q28, of half of it */
  if (mask_bits(lanes_greater(pressed, high)) != 0) return 0;
  LANES_UNROLL
  for (int k = 0; k < 3; ++k) {
    const lanes_root root = lanes_rsqrt(lanes64_dot(e[k], e[k]), &m);
    const lanes down = lanes_add(root.h, lanes_set(31 - 28 - BEND_PER_LENGTH_BITS));
    is_short |= mask_bits(lanes_greater(lanes_set(1), down)) != 0;
    length[k] = lanes_root_length(root, m);
    per_length[k] = lanes64_low(lanes64_shr_by(lanes64_mul_u(root.inverse, lanes_set(1)), down));
  }
  if (is_short || bend_prepare_lanes_thin(v, first, high, length)) return 0;
  LANES_UNROLL
  for (int k = 0; k < 3; ++k)
    lanes_store(v->plates + (PLATE_PER_LENGTH_0 + (uint32_t)k) * v->stride + first, per_length[k]);
  const lanes least = lanes64_low(lanes64_shr(squared, BEND_AREA_DOWN + 4));
  lanes_store(v->plates + PLATE_AREA_MIN * v->stride + first, lanes_add(least, lanes_shl(least, 3)));
  lanes_store(v->plates + PLATE_FADE * v->stride + first, lanes_set(BEND_ONE));
  return 1;
}

LANES_RUN_GROUPS(bend_stiffness_lanes_run, plate_view, bend_stiffness_lanes_group)
LANES_RUN_GROUPS(bend_geometry_lanes_run, plate_view, bend_geometry_lanes_group)
#endif

#endif
