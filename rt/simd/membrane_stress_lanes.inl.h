/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twins: rt/membrane/membrane_stress.c, the part of a tick, and rt/state/material.c, same order of
 * operations. Stiffness and stress of triangles, LANES at a time, by either law. Groups with a strain beyond
 * 1/2, or 2 of an isotropic sheet, or with a triangle that tearing left too low, are left to the scalar
 * code. */
#ifndef FRAY_SIMD_MEMBRANE_STRESS_LANES_INL_H
#define FRAY_SIMD_MEMBRANE_STRESS_LANES_INL_H

#include "rt/simd/material_direction_lanes.inl.h"
#include "rt/simd/membrane_force_lanes.inl.h"
#include "rt/state/deformation.h"

#ifdef LANES_HAVE_64
enum {
  MEMBRANE_STRESS_LANES_STRAIN = 27,
  MEMBRANE_STRESS_LANES_STRESS = 58,
  MEMBRANE_STRESS_LANES_ENERGY = 27
};

typedef struct {
  uint32_t of[LANES];
  lanes uu, vv, uv; /* strain, Q28 */
  lanes level, apart, share;
  int32_t row[LANES];
  int fades; /* whether a lane blends its row with the mean of all directions, as principal strains are
                nearly equal */
} membrane_stress_lanes;

/* Whether all triangles keep all of their stiffness: trimesh_gram_is_within(). */
LANES_INLINE int membrane_stress_lanes_is_whole(const lanes r[4], int32_t norm2_max) {
  const lanes max = lanes_set(norm2_max);
  const lanes u = lanes_add(r[0], r[1]);
  const lanes v = lanes_add(r[2], r[3]);
  const lanes uu = lanes64_high(
      lanes64_add(lanes64_add(lanes64_mul(r[0], r[0]), lanes64_mul(r[1], r[1])), lanes64_mul(u, u)));
  const lanes vv = lanes64_high(
      lanes64_add(lanes64_add(lanes64_mul(r[2], r[2]), lanes64_mul(r[3], r[3])), lanes64_mul(v, v)));
  const lanes uv = lanes64_high(
      lanes64_add(lanes64_add(lanes64_mul(r[0], r[2]), lanes64_mul(r[1], r[3])), lanes64_mul(u, v)));
  const lanes room_u = lanes_sub(max, uu);
  const lanes room_v = lanes_sub(max, vv);
  /* beyond 2^31 a square is negative, and so is the room where it is above the maximum */
  const lane_mask beyond = lanes_negative(lanes_min(lanes_min(uu, vv), lanes_min(room_u, room_v)));
  const lanes64 room = lanes64_sub(lanes64_mul(room_u, room_v), lanes64_mul(uv, uv));
  return mask_bits(mask_or(beyond, lanes64_negative(room))) == 0;
}

/* Returns 0 where a triangle is softened, or a strain has more than `bits` before it is rounded. */
LANES_INLINE int membrane_stress_lanes_strain(const stress_view *v, uint32_t first, unsigned bits,
                                              membrane_stress_lanes *s) {
  uint32_t id[3][LANES];
  lanes r[4], u[3], w[3];
  lanes64 far = lanes64_set(0);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) {
    s->of[n] = first + n;
    for (uint32_t k = 0; k < 3; ++k) id[k][n] = v->triangle[s->of[n]].v[k];
  }
  record_lanes_load(&v->weights->u1, 4, s->of, r);
  if (!membrane_stress_lanes_is_whole(r, v->norm2_max)) return 0;
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    const lanes d1 = lanes_shl(lanes_difference(v->at[n], id[0], id[1], DEFORMATION_REACH), 4);
    const lanes d2 = lanes_shl(lanes_difference(v->at[n], id[0], id[2], DEFORMATION_REACH), 4);
    u[n] = lanes_dot2(&far, d1, r[0], d2, r[1], TRIMESH_WEIGHT_BITS);
    w[n] = lanes_dot2(&far, d1, r[2], d2, r[3], TRIMESH_WEIGHT_BITS);
  }
  if (lanes64_any_beyond(far, TRIMESH_WEIGHT_BITS + 30)) return 0;
  const lanes64 one = lanes64_set((int64_t)1 << 2 * STRAIN_BITS);
  const lanes64 uu = lanes64_sub(lanes64_dot(u, u), one);
  const lanes64 vv = lanes64_sub(lanes64_dot(w, w), one);
  const lanes64 uv = lanes64_dot(u, w);
  far = lanes64_or_size(lanes64_or_size(lanes64_or_size(lanes64_set(0), uu), vv), uv);
  s->uu = lanes64_round(uu, STRAIN_BITS + 1);
  s->vv = lanes64_round(vv, STRAIN_BITS + 1);
  s->uv = lanes64_round(uv, STRAIN_BITS);
  return !lanes64_any_beyond(far, bits);
}

LANES_INLINE lanes membrane_stress_lanes_lowpass(lanes mean, lanes to, unsigned shift) {
  const lanes one = lanes_set(1);
  return lanes_add(mean, lanes64_round(lanes64_sub(lanes64_mul(to, one), lanes64_mul(mean, one)), shift));
}

/* Low-pass filters the strain in place, pole by pole; new states go to poles. */
LANES_INLINE void membrane_stress_lanes_smooth(const stress_view *v, const membrane_stress_lanes *s,
                                               lanes strain[3], lanes poles[SMOOTHED_STRAIN_POLES][3]) {
  const int32_t *from = &v->stiffness->mean[0].uu;
  lanes low[4], high[4];
  record_lanes_load(from, STIFFNESS_STATE_WORDS, s->of, low);
  record_lanes_load(from + 2, STIFFNESS_STATE_WORDS, s->of, high);
  const unsigned shift = v->smoothing_shift;
  const lanes means[SMOOTHED_STRAIN_POLES][3] = {{low[0], low[1], low[2]}, {low[3], high[2], high[3]}};
  LANES_UNROLL
  for (int pole = 0; pole < SMOOTHED_STRAIN_POLES; ++pole) {
    LANES_UNROLL
    for (int n = 0; n < 3; ++n)
      strain[n] = poles[pole][n] = membrane_stress_lanes_lowpass(means[pole][n], strain[n], shift);
  }
}

/* The place of a strain in the material table, as place_of() in material.c; returns 0 for large strains. */
LANES_INLINE int membrane_stress_lanes_look_up(membrane_stress_lanes *s, const lanes strain[3]) {
  const lanes zero = lanes_set(0);
  const lanes one = lanes_set(STRAIN_ONE);
  const lanes large =
      lanes_max(lanes_abs(strain[2]), lanes_max(lanes_abs(strain[0]), lanes_abs(strain[1])));
  if (mask_bits(lanes_greater(large, lanes_set(1 << MEMBRANE_STRESS_LANES_STRAIN))) != 0) return 0;
  const lanes x = lanes_asr(lanes_sub(strain[0], strain[1]), 1);
  const lanes y = lanes_asr(lanes_abs(strain[2]), 1);
  const lanes64 squared = lanes64_add(lanes64_mul(x, x), lanes64_mul(y, y));
  lanes m;
  const lanes_root root = lanes_rsqrt(squared, &m);
  const lane_mask same = lanes64_less(squared, 1);
  const lanes length = lanes_root_length(root, m);
  const lanes spread = lanes_select(same, zero, length);
  const lanes largest = lanes_add(lanes_asr(lanes_add(strain[0], strain[1]), 1), spread);
  const lane_mask drawn = lanes_greater(largest, zero);
  const lanes64 stretched =
      lanes64_shl(lanes64_from(lanes_add(one, lanes_shl(lanes_or_zero(drawn, largest), 1))), STRAIN_BITS);
  const lanes_root stretch = lanes_rsqrt(stretched, &m);
  const lanes over = lanes_sub(lanes_root_length(stretch, m), one);
  const lanes six = lanes_add(lanes_shl(over, 2), lanes_shl(over, 1));
  s->level = lanes_or_zero(drawn, lanes_max(zero, lanes_min(six, one)));
  const lane_mask some = lanes_greater(s->level, zero);
  /* 16 spread < largest: nearly the same strain in all directions */
  const lane_mask near =
      lanes_greater(lanes_asr(lanes_sub(largest, lanes_set(1)), 4), lanes_sub(spread, lanes_set(1)));
  const lanes part = lanes_add(lanes_asr(largest, 4), lanes_set(1));
  const lanes faded = lanes_ratio(lanes_or_zero(near, lanes_shl(spread, 4)), STRAIN_BITS - 4, part);
  s->apart = lanes_or_zero(some, lanes_select(near, faded, one));
  s->fades = mask_bits(mask_and(some, near)) != 0;
  const lanes at = lanes_or_zero(lanes_greater(s->apart, zero), lanes_material_direction(x, y));
  const lanes row = lanes_min(lanes_asr(at, STRAIN_BITS), lanes_set(MATERIAL_ROWS - 3));
  s->share = lanes_sub(at, lanes_shl(row, STRAIN_BITS));
  lanes_store(s->row, row);
  return 1;
}

LANES_INLINE lanes membrane_stress_lanes_lerp(lanes a, lanes b, lanes share) {
  return lanes_add(a, lanes_mul_q28(lanes_sub(b, a), share));
}

/* The mean stiffness over all directions; entries are not negative. */
LANES_INLINE void membrane_stress_lanes_mean(const int32_t *table, const uint32_t of[LANES],
                                             lanes mean[MATERIAL_ENTRIES]) {
  lanes rows[5][4];
  uint32_t at[LANES];
  for (uint32_t row = 0; row < 5; ++row) {
    for (uint32_t n = 0; n < (uint32_t)LANES; ++n) at[n] = of[n] + MATERIAL_ENTRIES * (1 + row);
    record_lanes_load(table, 1, at, rows[row]);
  }
  LANES_UNROLL
  for (int n = 0; n < MATERIAL_ENTRIES; ++n) {
    const lanes64 ends = lanes64_add(lanes64_from(rows[0][n]), lanes64_from(rows[4][n]));
    const lanes64 inner = lanes64_add(lanes64_add(lanes64_from(rows[1][n]), lanes64_from(rows[2][n])),
                                      lanes64_from(rows[3][n]));
    mean[n] = lanes64_round(lanes64_add(ends, lanes64_shl(inner, 1)), 3);
  }
}

LANES_INLINE void membrane_stress_lanes_stiffness(const stress_view *v, const membrane_stress_lanes *s,
                                                  lanes c[MATERIAL_ENTRIES]) {
  const int32_t *table = v->materials->stretch[0];
  uint32_t of[LANES], from[LANES], to[LANES];
  lanes rest[4], low[4], high[4], mean[4];
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) {
    of[n] = MATERIAL_WORDS * v->material[s->of[n]];
    from[n] = of[n] + MATERIAL_ENTRIES * (1u + (uint32_t)s->row[n]);
    to[n] = from[n] + MATERIAL_ENTRIES;
  }
  record_lanes_load(table, 1, of, rest);
  record_lanes_load(table, 1, from, low);
  record_lanes_load(table, 1, to, high);
  LANES_UNROLL
  for (int n = 0; n < MATERIAL_ENTRIES; ++n) mean[n] = rest[n];
  if (s->fades) membrane_stress_lanes_mean(table, of, mean);
  LANES_UNROLL
  for (int n = 0; n < MATERIAL_ENTRIES; ++n) {
    const lanes row = membrane_stress_lanes_lerp(low[n], high[n], s->share);
    const lane_mask whole = lanes_greater(s->apart, lanes_set(STRAIN_ONE - 1));
    const lanes drawn =
        s->fades ? lanes_select(whole, row, membrane_stress_lanes_lerp(mean[n], row, s->apart)) : row;
    c[n] = membrane_stress_lanes_lerp(rest[n], drawn, s->level);
  }
}

LANES_INLINE void membrane_stress_lanes_store(int32_t *to, uint32_t words, const lanes word[3]) {
  int32_t kept[3][LANES];
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) lanes_store(kept[n], word[n]);
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n)
    for (uint32_t k = 0; k < 3; ++k) to[words * n + k] = kept[k][n];
}

/* Stress, and material_energy() of it. Returns 0 where they are too large for lanes. */
LANES_INLINE int membrane_stress_lanes_energy(const stress_view *v, const lanes c[4],
                                              const membrane_stress_lanes *s, lanes stress[3],
                                              lanes *energy) {
  const lanes strain[3] = {s->uu, s->vv, s->uv};
  const lanes64 shear = lanes64_mul(c[3], s->uv);
  lanes64 far = lanes64_or_size(lanes64_set(0), shear);
  stress[0] = lanes_dot2(&far, c[0], s->uu, c[1], s->vv, STRAIN_BITS);
  stress[1] = lanes_dot2(&far, c[1], s->uu, c[2], s->vv, STRAIN_BITS);
  stress[2] = lanes64_round(shear, STRAIN_BITS);
  const lanes64 sum = lanes64_dot(stress, strain);
  *energy = lanes64_round(sum, v->energy_shift);
  return !lanes64_any_beyond(far, MEMBRANE_STRESS_LANES_STRESS) &&
         !lanes64_any_beyond(lanes64_or_size(lanes64_set(0), sum),
                             v->energy_shift + MEMBRANE_STRESS_LANES_ENERGY);
}

/* Whether the law of strain_law.h may apply to one of them. */
LANES_INLINE int membrane_stress_lanes_beyond(const stress_view *v, uint32_t first,
                                              const membrane_stress_lanes *s) {
  const lanes size = lanes_add(lanes_max(s->uu, s->vv), lanes_asr(lanes_abs(s->uv), 1));
  return mask_bits(lanes_greater(size, lanes_load(v->strain_threshold + first))) != 0;
}

LANES_INLINE int membrane_stress_lanes_group(const stress_view *v, uint32_t first) {
  membrane_stress_lanes s;
  lanes c[4], target[4], rest[4], stress[3], was, full, now, poles[SMOOTHED_STRAIN_POLES][3];
  if (!membrane_stress_lanes_strain(v, first, MEMBRANE_STRESS_LANES_STRAIN + STRAIN_BITS, &s)) return 0;
  if (membrane_stress_lanes_beyond(v, first, &s)) return 0;
  lanes strain[3] = {s.uu, s.vv, s.uv};
  membrane_stress_lanes_smooth(v, &s, strain, poles);
  if (!membrane_stress_lanes_look_up(&s, strain)) return 0;
  membrane_stress_lanes_stiffness(v, &s, target);
  record_lanes_load(v->stiffness->c, STIFFNESS_STATE_WORDS, s.of, c);
  record_lanes_load(v->stiffness->c + 1, STIFFNESS_STATE_WORDS, s.of, rest);
  if (mask_bits(lanes_greater(lanes_set(1), c[0])) != 0) return 0; /* their first tick */
  if (!membrane_stress_lanes_energy(v, c, &s, stress, &was) ||
      !membrane_stress_lanes_energy(v, target, &s, stress, &full) ||
      mask_bits(lanes_greater(full, lanes_set(MATERIAL_ENERGY_MAX - 1))) != 0)
    return 0;
  const lanes times = lanes_add(lanes_shl(was, 1), was); /* STIFFNESS_RISE */
  const lanes slowly =
      lanes_max(lanes_asr(times, v->smoothing_shift + STIFFNESS_RISE_BITS), lanes_set(MATERIAL_ENERGY_LEAST));
  const lanes rise = lanes_sub(full, was);
  const lanes room = lanes_max(lanes_sub(lanes_set(0), rest[3]), slowly);
  const lane_mask held = lanes_greater(rise, room);
  if (mask_bits(held) != 0) {
    const lanes part = lanes_ratio(room, 30, rise);
    LANES_UNROLL
    for (int n = 0; n < MATERIAL_ENTRIES; ++n) {
      const lanes way = lanes64_round(lanes64_mul(lanes_sub(target[n], c[n]), part), 30);
      const lanes less = lanes_add(c[n], way);
      target[n] = lanes_select(held, less, target[n]);
    }
  }
  if (!membrane_stress_lanes_energy(v, target, &s, stress, &now)) return 0;
  const lanes owed = lanes_sub(lanes_add(rest[3], now), was);
  const lanes debt = lanes_min(owed, lanes_set(MATERIAL_ENERGY_MAX));
  const lanes last[3] = {target[2], target[3], lanes_max(debt, lanes_sub(lanes_set(0), now))};
  stiffness_state *to = &v->stiffness[first];
  for (uint32_t pole = 0; pole < SMOOTHED_STRAIN_POLES; ++pole)
    membrane_stress_lanes_store(&to->mean[pole].uu, STIFFNESS_STATE_WORDS, poles[pole]);
  membrane_stress_lanes_store(to->c, STIFFNESS_STATE_WORDS, target);
  membrane_stress_lanes_store(to->c + 2, STIFFNESS_STATE_WORDS, last);
  membrane_stress_lanes_store(&v->stress[first].uu, sizeof(material_tensor) / 4, stress);
  return 1;
}

/* Whole groups of LANES, until one is left to the scalar code. */
LANES_INLINE uint32_t membrane_stress_lanes_run(const stress_view *v, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first <= end && v->smoothing_shift < 32);
  uint32_t at = first;
  if (v->smoothing_shift == 0) return 0; /* c depends on the unfiltered strain: patch tests */
  while (end - at >= (uint32_t)LANES && membrane_stress_lanes_group(v, at)) at += (uint32_t)LANES;
  return at - first;
}

#if FRAY_CRACKS
LANES_INLINE int corotational_stress_lanes_group(const stress_view *v, uint32_t first) {
  membrane_stress_lanes s;
  uint32_t of[LANES];
  lanes c[4], stress[3];
  if (!membrane_stress_lanes_strain(v, first, COROTATIONAL_LANES_STRAIN, &s)) return 0;
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) of[n] = MATERIAL_WORDS * v->material[s.of[n]];
  record_lanes_load(v->materials->stretch[0], 1, of, c);
  const lanes strain[3] = {s.uu, s.vv, s.uv};
  corotational_lanes_tension_of(c, strain, stress);
  membrane_stress_lanes_store(&v->stress[first].uu, sizeof(material_tensor) / 4, stress);
  return 1;
}

LANES_RUN_WHOLE_GROUPS(corotational_stress_lanes_run, stress_view, corotational_stress_lanes_group)
#endif
#endif

#endif
