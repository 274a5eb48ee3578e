/* SPDX-License-Identifier: Apache-2.0 */
/* Bend and shear springs between free particles: stage/springs.c says what they compute. */
#ifndef FRAY_WIDE_PUSH_H
#define FRAY_WIDE_PUSH_H

#include "rt/wide/pairs.h"
#include "rt/wide/spring.h"

LANES_INLINE lanes push_horner(lanes x, lanes y, int32_t constant) {
  return lanes_add(lanes_asr(lanes_mul(x, y), 15), lanes_all(constant));
}

LANES_INLINE lanes push_share(lanes t) {
  const lane_mask far_up = lanes_above(lanes_all(4096), t);
  const lanes nearer = lanes_pick(far_up, lanes_shl(t, 4), t);
  const lane_mask up = lanes_above(lanes_all(16384), nearer);
  const lanes x = lanes_sub(lanes_pick(up, lanes_shl(nearer, 2), nearer), lanes_all(32768));
  lanes y = push_horner(x, lanes_all(SPRING_SERIES_4), SPRING_SERIES_3);
  y = push_horner(x, y, SPRING_SERIES_2);
  y = push_horner(x, y, SPRING_SERIES_1);
  const lanes s = lanes_asr(lanes_add(lanes_mul(x, y), lanes_all(1 << 14)), 15);
  const lanes root = lanes_sub(lanes_all(16384), s);
  const lanes once = lanes_pick(up, lanes_shl(root, 1), root);
  return lanes_sub(lanes_all(16384), lanes_pick(far_up, lanes_shl(once, 2), once));
}

/* `half` is half of 2^s */
LANES_INLINE lanes push_round_by(lanes v, lanes half, lanes s) {
  return lanes_asr_by(lanes_add(v, lanes_add(lanes_sign(v), half)), s);
}
LANES_INLINE lanes push_half(lanes s) {
  return lanes_shl_by(lanes_all(1), lanes_sub(s, lanes_all(1)));
}
/* From i to j in a row's own units. */
LANES_INLINE lanes push_way(const pairs *p, const int32_t *at, lanes half, lanes down) {
  const lanes way = lanes_sub(pairs_fetch_j(p, at), pairs_fetch_i(p, at));
  return lanes_clamp(push_round_by(way, half, down), SPRING_HI_MAX);
}

/* Of rows that act, 0 of others. */
LANES_INLINE lanes push_pull(lanes n, const pairs *p, const spring_class *c) {
  const lane_mask acts = lanes_above(pairs_class(p, &c->idle, SPRING_CLASS_WORDS), n);
  const lanes r2 = pairs_class(p, &c->r2, SPRING_CLASS_WORDS);
  const lanes inverse = pairs_class(p, &c->inverse, SPRING_CLASS_WORDS);
  const lanes e = lanes_sub(lanes_min(n, lanes_shl(r2, 1)), r2);
  const lanes scaled = lanes_mul(lanes_round(e, 12), inverse);
  const lanes u = lanes_asr(lanes_add(scaled, lanes_all(1 << 11)), 12);
  const lanes t = lanes_max(lanes_add(lanes_all(32768), u), lanes_all(SPRING_T_LEAST));
  const lanes share = lanes_keep(acts, push_share(t));
  return lanes_round(lanes_mul(share, pairs_class(p, &c->pull, SPRING_CLASS_WORDS)), 14);
}

LANES_INLINE int push_acts(lanes n, const pairs *p, const spring_class *c) {
  return lanes_bits(lanes_above(pairs_class(p, &c->idle, SPRING_CLASS_WORDS), n)) != 0;
}

LANES_INLINE lanes push_step(lanes d, lanes pull, lanes half, lanes scale) {
  return lanes_clamp(push_round_by(lanes_mul(d, pull), half, scale), SPRING_DV_MAX);
}

LANES_INLINE void push_pairs(const void *view, const pairs *p) {
  const spring_view *s = (const spring_view *)view;
  const spring_class *c = s->classes;
  int32_t *const speed[3] = {s->vx, s->vy, s->vz};
  const lanes down = pairs_class(p, &c->down, SPRING_CLASS_WORDS);
  const lanes down_half = push_half(down);
  const lanes d[3] = {push_way(p, s->x, down_half, down), push_way(p, s->y, down_half, down),
                      push_way(p, s->z, down_half, down)};
  const lanes n = lanes_dot(d, d);
  if (!push_acts(n, p, c)) return;
  const lanes pull = push_pull(n, p, c);
  const lanes scale = pairs_class(p, &c->scale, SPRING_CLASS_WORDS);
  const lanes scale_half = push_half(scale);
  const int light = pairs_light(p);
  lanes i[3], j[3]; /* all of them before any is stored: a load near a store that is under way waits for it */
  LANES_UNROLLED
  for (int a = 0; a < 3; ++a) {
    i[a] = pairs_fetch_i(p, speed[a]);
    j[a] = pairs_fetch_j(p, speed[a]);
  }
  LANES_UNROLLED
  for (int a = 0; a < 3; ++a) {
    const lanes dv = push_step(d[a], pull, scale_half, scale);
    pairs_put_i(p, speed[a], lanes_add(i[a], light ? pairs_weighted(p, dv, ROW_UP_I) : dv));
    pairs_put_j(p, speed[a], lanes_sub(j[a], light ? pairs_weighted(p, dv, ROW_UP_J) : dv));
  }
}

#ifdef LANES_MANY
LANES_INLINE void push_many(const void *view, const pairs_many *m) {
  const spring_view *s = (const spring_view *)view;
  const spring_class *c = s->classes;
  const int32_t *const at[3] = {s->x, s->y, s->z};
  int32_t *const speed[3] = {s->vx, s->vy, s->vz};
  const lanes down = pairs_class(&m->one, &c->down, SPRING_CLASS_WORDS);
  const lanes scale = pairs_class(&m->one, &c->scale, SPRING_CLASS_WORDS);
  const lanes down_half = push_half(down);
  const lanes scale_half = push_half(scale);
  lanes d[LANES_MANY][3];
  lanes pull[LANES_MANY];
  row_id i[LANES_MANY], j[LANES_MANY];
  uint32_t count = 0; /* of groups that act */
  for (uint32_t g = 0; g < m->count; ++g) {
    i[count] = m->i[g];
    j[count] = m->j[g];
    LANES_UNROLLED
    for (int a = 0; a < 3; ++a) {
      const lanes way = lanes_sub(lanes_load(at[a] + m->j[g]), lanes_load(at[a] + m->i[g]));
      d[count][a] = lanes_clamp(push_round_by(way, down_half, down), SPRING_HI_MAX);
    }
    pull[count] = lanes_dot(d[count], d[count]);
    count += push_acts(pull[count], &m->one, c) ? 1u : 0u;
  }
  for (uint32_t g = 0; g < count; ++g) pull[g] = push_pull(pull[g], &m->one, c);
  for (uint32_t g = 0; g < count; ++g) {
    LANES_UNROLLED
    for (int a = 0; a < 3; ++a) {
      const lanes dv = push_step(d[g][a], pull[g], scale_half, scale);
      int32_t *of_i = speed[a] + i[g];
      int32_t *of_j = speed[a] + j[g];
      lanes_store(of_i, lanes_add(lanes_load(of_i), dv));
      lanes_store(of_j, lanes_sub(lanes_load(of_j), dv));
    }
  }
}
#else
#define push_many NULL
#endif

LANES_INLINE uint32_t push_batches(spring_view s, const row_batch *batches, uint32_t count) {
  const pair_rows rows = {s.i, s.j, s.kind};
  return pairs_each(&rows, batches, count, push_pairs, push_many, &s);
}

#endif
