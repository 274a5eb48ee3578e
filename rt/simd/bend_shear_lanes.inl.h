/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/woven/bend_shear.c. Bend and shear springs between free particles, LANES at a time. */
#ifndef FRAY_SIMD_BEND_SHEAR_LANES_INL_H
#define FRAY_SIMD_BEND_SHEAR_LANES_INL_H

#include "rt/simd/spring_lanes.inl.h"
#include "rt/simd/spring_terms.h"

LANES_INLINE lanes bend_shear_lanes_horner(lanes x, lanes y, int32_t constant) {
  return lanes_add(lanes_asr(lanes_mul(x, y), 15), lanes_set(constant));
}

LANES_INLINE lanes bend_shear_lanes_share(lanes t) {
  const lane_mask far_up = lanes_greater(lanes_set(4096), t);
  const lanes nearer = lanes_select(far_up, lanes_shl(t, 4), t);
  const lane_mask up = lanes_greater(lanes_set(16384), nearer);
  const lanes x = lanes_sub(lanes_select(up, lanes_shl(nearer, 2), nearer), lanes_set(32768));
  lanes y = bend_shear_lanes_horner(x, lanes_set(BEND_SHEAR_SERIES_4), BEND_SHEAR_SERIES_3);
  y = bend_shear_lanes_horner(x, y, BEND_SHEAR_SERIES_2);
  y = bend_shear_lanes_horner(x, y, BEND_SHEAR_SERIES_1);
  const lanes s = lanes_asr(lanes_add(lanes_mul(x, y), lanes_set(1 << 14)), 15);
  const lanes root = lanes_sub(lanes_set(16384), s);
  const lanes once = lanes_select(up, lanes_shl(root, 1), root);
  return lanes_sub(lanes_set(16384), lanes_select(far_up, lanes_shl(once, 2), once));
}

/* `half` is half of 2^s */
LANES_INLINE lanes bend_shear_lanes_round_by(lanes v, lanes half, lanes s) {
  return lanes_asr_by(lanes_add(v, lanes_add(lanes_sign(v), half)), s);
}
LANES_INLINE lanes bend_shear_lanes_half(lanes s) {
  return lanes_shl_by(lanes_set(1), lanes_sub(s, lanes_set(1)));
}
/* x_j - x_i in the units of the spring's class. */
LANES_INLINE lanes bend_shear_lanes_difference(const spring_lanes *p, const int32_t *at, lanes half,
                                               lanes down) {
  const lanes way = lanes_sub(spring_lanes_load_j(p, at), spring_lanes_load_i(p, at));
  return lanes_clamp(bend_shear_lanes_round_by(way, half, down), BEND_SHEAR_HI_MAX);
}

/* The gain of springs that act, 0 for inactive ones. */
LANES_INLINE lanes bend_shear_lanes_pull(lanes n, const spring_lanes *p, const bend_shear_class *c) {
  const lane_mask acts = lanes_greater(spring_lanes_class(p, &c->inactive_r2, BEND_SHEAR_CLASS_WORDS), n);
  const lanes r2 = spring_lanes_class(p, &c->r2, BEND_SHEAR_CLASS_WORDS);
  const lanes inverse = spring_lanes_class(p, &c->inverse, BEND_SHEAR_CLASS_WORDS);
  const lanes e = lanes_sub(lanes_min(n, lanes_shl(r2, 1)), r2);
  const lanes scaled = lanes_mul(lanes_round(e, 12), inverse);
  const lanes u = lanes_asr(lanes_add(scaled, lanes_set(1 << 11)), 12);
  const lanes t = lanes_max(lanes_add(lanes_set(32768), u), lanes_set(BEND_SHEAR_T_MIN));
  const lanes share = lanes_or_zero(acts, bend_shear_lanes_share(t));
  return lanes_round(lanes_mul(share, spring_lanes_class(p, &c->gain, BEND_SHEAR_CLASS_WORDS)), 14);
}

LANES_INLINE int bend_shear_lanes_acts(lanes n, const spring_lanes *p, const bend_shear_class *c) {
  return mask_bits(lanes_greater(spring_lanes_class(p, &c->inactive_r2, BEND_SHEAR_CLASS_WORDS), n)) != 0;
}

LANES_INLINE lanes bend_shear_lanes_step(lanes d, lanes pull, lanes half, lanes scale) {
  return lanes_clamp(bend_shear_lanes_round_by(lanes_mul(d, pull), half, scale), BEND_SHEAR_DV_MAX);
}

LANES_INLINE void bend_shear_lanes_pairs(const void *view, const spring_lanes *p) {
  const bend_shear_view *s = (const bend_shear_view *)view;
  const bend_shear_class *c = s->classes;
  int32_t *const speed[3] = {s->vx, s->vy, s->vz};
  const lanes down = spring_lanes_class(p, &c->down, BEND_SHEAR_CLASS_WORDS);
  const lanes down_half = bend_shear_lanes_half(down);
  const lanes d[3] = {bend_shear_lanes_difference(p, s->x, down_half, down),
                      bend_shear_lanes_difference(p, s->y, down_half, down),
                      bend_shear_lanes_difference(p, s->z, down_half, down)};
  const lanes n = lanes_dot(d, d);
  if (!bend_shear_lanes_acts(n, p, c)) return;
  const lanes pull = bend_shear_lanes_pull(n, p, c);
  const lanes scale = spring_lanes_class(p, &c->scale, BEND_SHEAR_CLASS_WORDS);
  const lanes scale_half = bend_shear_lanes_half(scale);
  const int half_mass = spring_lanes_any_half_mass(p);
  lanes i[3], j[3]; /* all are loaded before any is stored: a load next to a pending store stalls */
  LANES_UNROLL_3
  for (int a = 0; a < 3; ++a) {
    i[a] = spring_lanes_load_i(p, speed[a]);
    j[a] = spring_lanes_load_j(p, speed[a]);
  }
  LANES_UNROLL_3
  for (int a = 0; a < 3; ++a) {
    const lanes dv = bend_shear_lanes_step(d[a], pull, scale_half, scale);
    spring_lanes_store_i(p, speed[a],
                         lanes_add(i[a], half_mass ? spring_lanes_by_mass(p, dv, SPRING_HALF_I) : dv));
    spring_lanes_store_j(p, speed[a],
                         lanes_sub(j[a], half_mass ? spring_lanes_by_mass(p, dv, SPRING_HALF_J) : dv));
  }
}

#ifdef LANES_GROUPS
LANES_INLINE void bend_shear_lanes_groups(const void *view, const spring_groups *m) {
  const bend_shear_view *s = (const bend_shear_view *)view;
  const bend_shear_class *c = s->classes;
  const int32_t *const at[3] = {s->x, s->y, s->z};
  int32_t *const speed[3] = {s->vx, s->vy, s->vz};
  const lanes down = spring_lanes_class(&m->one, &c->down, BEND_SHEAR_CLASS_WORDS);
  const lanes scale = spring_lanes_class(&m->one, &c->scale, BEND_SHEAR_CLASS_WORDS);
  const lanes down_half = bend_shear_lanes_half(down);
  const lanes scale_half = bend_shear_lanes_half(scale);
  lanes d[LANES_GROUPS][3];
  lanes pull[LANES_GROUPS];
  index_t i[LANES_GROUPS], j[LANES_GROUPS];
  uint32_t count = 0; /* of groups with an active spring */
  for (uint32_t g = 0; g < m->count; ++g) {
    i[count] = m->i[g];
    j[count] = m->j[g];
    LANES_UNROLL_3
    for (int a = 0; a < 3; ++a) {
      const lanes way = lanes_sub(lanes_load(at[a] + m->j[g]), lanes_load(at[a] + m->i[g]));
      d[count][a] = lanes_clamp(bend_shear_lanes_round_by(way, down_half, down), BEND_SHEAR_HI_MAX);
    }
    pull[count] = lanes_dot(d[count], d[count]);
    count += bend_shear_lanes_acts(pull[count], &m->one, c) ? 1u : 0u;
  }
  for (uint32_t g = 0; g < count; ++g) pull[g] = bend_shear_lanes_pull(pull[g], &m->one, c);
  for (uint32_t g = 0; g < count; ++g) {
    LANES_UNROLL_3
    for (int a = 0; a < 3; ++a) {
      const lanes dv = bend_shear_lanes_step(d[g][a], pull[g], scale_half, scale);
      int32_t *of_i = speed[a] + i[g];
      int32_t *of_j = speed[a] + j[g];
      lanes_store(of_i, lanes_add(lanes_load(of_i), dv));
      lanes_store(of_j, lanes_sub(lanes_load(of_j), dv));
    }
  }
}
#else
#define bend_shear_lanes_groups NULL
#endif

LANES_INLINE uint32_t bend_shear_lanes_run(bend_shear_view s, const spring_batch *batches, uint32_t count) {
  const spring_rows rows = {s.i, s.j, s.kind};
  return spring_lanes_batches(&rows, batches, count, bend_shear_lanes_pairs, bend_shear_lanes_groups, &s);
}

#endif
