/* SPDX-License-Identifier: Apache-2.0 */
/* The projection of links between free particles: stage/strain.c says what it computes. */
#ifndef FRAY_WIDE_PROJECT_H
#define FRAY_WIDE_PROJECT_H

#include "rt/wide/link.h"
#include "rt/wide/pairs.h"

#ifndef LANES_TABLE
#define LANES_TABLE 1
#define lanes_from(table, at) lanes_load(table) /* never */
#endif

/* Words of classes that rows of many kinds look up in lanes. */
typedef enum { PROJECT_R2, PROJECT_N_MAX, PROJECT_INVERSE, PROJECT_PUSH, PROJECT_WORDS } project_name;
typedef struct {
  link_view at;
  int has_table; /* which has place for all classes */
  int32_t table[PROJECT_WORDS][LANES_TABLE];
} project_view;

LANES_INLINE void project_fill(project_view *v) {
  const uint32_t count = v->at.class_count;
  v->has_table = count > 0 && LANES_TABLE > 1 && count <= LANES_TABLE;
  if (!v->has_table) return;
  for (uint32_t n = 0; n < LANES_TABLE; ++n) {
    const link_class *c = &v->at.classes[n < count ? n : 0];
    v->table[PROJECT_R2][n] = c->r2;
    v->table[PROJECT_N_MAX][n] = c->n_max;
    v->table[PROJECT_INVERSE][n] = c->inverse;
    v->table[PROJECT_PUSH][n] = c->push;
  }
}

LANES_INLINE lanes project_word(const project_view *v, const pairs *p, project_name name,
                                const int32_t *words) {
  if (!p->one_class && v->has_table)
    return lanes_from(v->table[name], lanes_load((const int32_t *)p->kinds));
  return pairs_class(p, words, LINK_CLASS_WORDS);
}

LANES_INLINE lanes project_factor(const project_view *v, lanes n, const pairs *p, const link_words *k) {
  const link_class *c = v->at.classes;
  const lanes e = lanes_sub(n, project_word(v, p, PROJECT_R2, &c->r2));
  const lanes inverse = project_word(v, p, PROJECT_INVERSE, &c->inverse);
  const lanes push = project_word(v, p, PROJECT_PUSH, &c->push);
  const lanes scaled = lanes_mul(lanes_asr(lanes_add(e, lanes_word(&k->e_half)), 5), inverse);
  const lanes u = lanes_max(lanes_asr(lanes_add(scaled, lanes_word(&k->u_half)), 11),
                            lanes_word(&k->u_least));
  const lanes u_q15 = lanes_asr(u, 5);
  const lanes slope = lanes_asr(lanes_add(lanes_mul(u_q15, lanes_word(&k->psi_2)),
                                          lanes_word(&k->horner_1)), 15);
  const lanes psi =
      lanes_asr(lanes_add(lanes_mul(u_q15, slope), lanes_word(&k->horner_0)), 18);
  const lanes f = lanes_asr(lanes_add(lanes_mul(u, psi), lanes_word(&k->f_half)), 13);
  return lanes_pick(lanes_below_zero(u), lanes_asr(lanes_mul(f, push), 12), f);
}

/* The upper part of a way, within what a product takes. */
LANES_INLINE lanes project_upper(lanes way, const link_words *k) {
  const lanes rounded = lanes_round_with(way, lanes_word(&k->way_half), LINK_SHIFT);
  return lanes_max(lanes_min(rounded, lanes_word(&k->hi_most)), lanes_word(&k->hi_least));
}

/* |d|^2, at most n_max: what is clamped comes out above it, whatever stands in its low bits. */
LANES_INLINE lanes project_squared(const lanes d[3], const lanes hi[3], lanes n_max) {
  const lanes n_hi = lanes_dot(hi, hi);
  const lanes cross = lanes_sub(lanes_dot(hi, d), lanes_shl(n_hi, LINK_SHIFT));
  return lanes_min(lanes_add(n_hi, lanes_asr(cross, LINK_SHIFT - 1)), n_max);
}

LANES_INLINE lanes project_step(lanes hi, lanes f, const link_words *k) {
  return lanes_round_with(lanes_mul(hi, f), lanes_word(&k->step_half), 20 - LINK_SHIFT);
}

/* Where one of the ends is light. */
LANES_INLINE lanes project_third(const pairs *p, lanes f) {
  const lanes part =
      lanes_asr(lanes_add(lanes_mul(f, lanes_all(LINK_THIRD)), lanes_all(1 << 11)), 12);
  return p->one_class ? part : lanes_pick(pairs_with(p, ROW_LIGHT), part, f);
}

LANES_INLINE void project_pairs(const void *view, const pairs *p) {
  const project_view *v = (const project_view *)view;
  const link_view *s = &v->at;
  const link_words *k = &wide_link_words;
  int32_t *const at[3] = {s->x, s->y, s->z};
  const lanes i[3] = {pairs_fetch_i(p, s->x), pairs_fetch_i(p, s->y), pairs_fetch_i(p, s->z)};
  const lanes j[3] = {pairs_fetch_j(p, s->x), pairs_fetch_j(p, s->y), pairs_fetch_j(p, s->z)};
  const lanes d[3] = {lanes_sub(j[0], i[0]), lanes_sub(j[1], i[1]), lanes_sub(j[2], i[2])};
  const lanes hi[3] = {project_upper(d[0], k), project_upper(d[1], k), project_upper(d[2], k)};
  const lanes n = project_squared(d, hi, project_word(v, p, PROJECT_N_MAX, &s->classes->n_max));
  lanes f = project_factor(v, n, p, k);
  const int light = pairs_light(p);
  if (light) f = project_third(p, f);
  LANES_UNROLLED
  for (int a = 0; a < 3; ++a) {
    const lanes c = project_step(hi[a], f, k);
    pairs_put_i(p, at[a], lanes_add(i[a], light ? pairs_weighted(p, c, ROW_UP_I) : c));
    pairs_put_j(p, at[a], lanes_sub(j[a], light ? pairs_weighted(p, c, ROW_UP_J) : c));
  }
}

#ifdef LANES_MANY
LANES_INLINE void project_groups(const project_view *v, const pairs_many *m, uint32_t count) {
  const link_view *s = &v->at;
  const link_words *k = &wide_link_words;
  int32_t *const at[3] = {s->x, s->y, s->z};
  const lanes n_max = pairs_class(&m->one, &s->classes->n_max, LINK_CLASS_WORDS);
  lanes hi[LANES_MANY][3];
  lanes f[LANES_MANY];
  for (uint32_t g = 0; g < count; ++g) {
    lanes d[3];
    LANES_UNROLLED
    for (int a = 0; a < 3; ++a) {
      d[a] = lanes_sub(lanes_load(at[a] + m->j[g]), lanes_load(at[a] + m->i[g]));
      hi[g][a] = project_upper(d[a], k);
    }
    f[g] = project_squared(d, hi[g], n_max);
  }
  for (uint32_t g = 0; g < count; ++g) f[g] = project_factor(v, f[g], &m->one, k);
  for (uint32_t g = 0; g < count; ++g) {
    LANES_UNROLLED
    for (int a = 0; a < 3; ++a) {
      const lanes c = project_step(hi[g][a], f[g], k);
      int32_t *i = at[a] + m->i[g];
      int32_t *j = at[a] + m->j[g];
      lanes_store(i, lanes_add(lanes_load(i), c));
      lanes_store(j, lanes_sub(lanes_load(j), c));
    }
  }
}

/* Most are full, which compilers unroll. */
LANES_INLINE void project_many(const void *view, const pairs_many *m) {
  if (m->count == LANES_MANY)
    project_groups((const project_view *)view, m, LANES_MANY);
  else
    project_groups((const project_view *)view, m, m->count);
}
#else
#define project_many NULL
#endif

LANES_INLINE uint32_t project_batches(link_view s, const row_batch *batches, uint32_t count) {
  const pair_rows rows = {s.i, s.j, s.kind};
  project_view v = {s, 0, {{0}}};
  project_fill(&v);
  return pairs_each(&rows, batches, count, project_pairs, project_many, &v);
}

#endif
