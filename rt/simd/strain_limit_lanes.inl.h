/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/woven/strain_limit.c. Strain limiting of links between free particles, LANES at a time.
 */
#ifndef FRAY_SIMD_STRAIN_LIMIT_LANES_INL_H
#define FRAY_SIMD_STRAIN_LIMIT_LANES_INL_H

#include "rt/simd/link_terms.h"
#include "rt/simd/spring_lanes.inl.h"

#ifndef LANES_TABLE_WORDS
#define LANES_TABLE_WORDS 1
#define lanes_lookup(table, at) lanes_load(table) /* never called */
#endif

/* Words of link classes, by class, for groups of mixed classes. */
typedef enum {
  STRAIN_LIMIT_LANES_R2,
  STRAIN_LIMIT_LANES_N_MAX,
  STRAIN_LIMIT_LANES_INVERSE,
  STRAIN_LIMIT_LANES_PUSH,
  STRAIN_LIMIT_LANES_WORDS
} strain_limit_lanes_name;
typedef struct {
  link_view at;
  int32_t far;   /* lock_far() of diagonals */
  int has_table; /* whether the table holds all classes */
  int32_t table[STRAIN_LIMIT_LANES_WORDS][LANES_TABLE_WORDS];
} strain_limit_lanes_view;

LANES_INLINE void strain_limit_lanes_fill(strain_limit_lanes_view *v) {
  const uint32_t count = v->at.class_count;
  v->has_table = count > 0 && LANES_TABLE_WORDS > 1 && count <= LANES_TABLE_WORDS;
  if (!v->has_table) return;
  for (uint32_t n = 0; n < LANES_TABLE_WORDS; ++n) {
    const link_class *c = &v->at.classes[n < count ? n : 0];
    v->table[STRAIN_LIMIT_LANES_R2][n] = c->r2;
    v->table[STRAIN_LIMIT_LANES_N_MAX][n] = c->n_max;
    v->table[STRAIN_LIMIT_LANES_INVERSE][n] = c->inverse;
    v->table[STRAIN_LIMIT_LANES_PUSH][n] = c->push;
  }
}

LANES_INLINE lanes strain_limit_lanes_word(const strain_limit_lanes_view *v, const spring_lanes *p,
                                           strain_limit_lanes_name name, const int32_t *words) {
  if (!p->one_class && v->has_table)
    return lanes_lookup(v->table[name], lanes_load((const int32_t *)p->kinds));
  return spring_lanes_class(p, words, LINK_CLASS_WORDS);
}

LANES_INLINE lanes strain_limit_lanes_factor(const strain_limit_lanes_view *v, lanes n,
                                             const spring_lanes *p, const link_words *k) {
  const link_class *c = v->at.classes;
  const lanes e = lanes_sub(n, strain_limit_lanes_word(v, p, STRAIN_LIMIT_LANES_R2, &c->r2));
  const lanes inverse = strain_limit_lanes_word(v, p, STRAIN_LIMIT_LANES_INVERSE, &c->inverse);
  const lanes push = strain_limit_lanes_word(v, p, STRAIN_LIMIT_LANES_PUSH, &c->push);
  const lanes scaled = lanes_mul(lanes_asr(lanes_add(e, lanes_set_from(&k->e_half)), 5), inverse);
  const lanes u =
      lanes_max(lanes_asr(lanes_add(scaled, lanes_set_from(&k->u_half)), 11), lanes_set_from(&k->u_least));
  const lanes u_q15 = lanes_asr(u, 5);
  const lanes slope =
      lanes_asr(lanes_add(lanes_mul(u_q15, lanes_set_from(&k->psi_2)), lanes_set_from(&k->horner_1)), 15);
  const lanes psi = lanes_asr(lanes_add(lanes_mul(u_q15, slope), lanes_set_from(&k->horner_0)), 18);
  const lanes f = lanes_asr(lanes_add(lanes_mul(u, psi), lanes_set_from(&k->f_half)), 13);
  return lanes_select(lanes_negative(u), lanes_asr(lanes_mul(f, push), 12), f);
}

/* link_coarse(): a component of d in units of 2^LINK_SHIFT, in 15 bits and a sign. */
LANES_INLINE lanes strain_limit_lanes_coarse(lanes way, const link_words *k) {
  const lanes rounded = lanes_round_with(way, lanes_set_from(&k->difference_half), LINK_SHIFT);
  return lanes_max(lanes_min(rounded, lanes_set_from(&k->hi_most)), lanes_set_from(&k->hi_least));
}

/* link_squared(), at most n_max: a d with a clamped component is above it, whatever its low bits. */
LANES_INLINE lanes strain_limit_lanes_squared(const lanes d[3], const lanes hi[3], lanes n_max) {
  const lanes n_hi = lanes_dot(hi, hi);
  const lanes cross = lanes_sub(lanes_dot(hi, d), lanes_shl(n_hi, LINK_SHIFT));
  return lanes_min(lanes_add(n_hi, lanes_asr(cross, LINK_SHIFT - 1)), n_max);
}

LANES_INLINE lanes strain_limit_lanes_step(lanes hi, lanes f, const link_words *k) {
  return lanes_round_with(lanes_mul(hi, f), lanes_set_from(&k->step_half), 20 - LINK_SHIFT);
}

/* 2/3 f for springs with an end of half mass. */
LANES_INLINE lanes strain_limit_lanes_two_thirds(const spring_lanes *p, lanes f) {
  const lanes part = lanes_asr(lanes_add(lanes_mul(f, lanes_set(LINK_THIRD)), lanes_set(1 << 11)), 12);
  return p->one_class ? part : lanes_select(spring_lanes_with(p, SPRING_HALF_MASS), part, f);
}

LANES_INLINE lanes strain_limit_lanes_size(lanes d) {
  const lanes v = lanes_asr(d, LOCK_FAR_SHIFT);
  return lanes_max(v, lanes_sub(lanes_set(0), v));
}

/* 1 iff all are diagonals, far longer than their lock. */
LANES_INLINE int strain_limit_lanes_far(const strain_limit_lanes_view *v, const lanes d[3]) {
  if (!v->at.is_lock) return 0;
  const lanes sum = lanes_add(lanes_add(strain_limit_lanes_size(d[0]), strain_limit_lanes_size(d[1])),
                              strain_limit_lanes_size(d[2]));
  return mask_bits(lanes_negative(lanes_sub(sum, lanes_set(v->far)))) == 0;
}

LANES_INLINE void strain_limit_lanes_pairs(const void *view, const spring_lanes *p) {
  const strain_limit_lanes_view *v = (const strain_limit_lanes_view *)view;
  const link_view *s = &v->at;
  const link_words *k = &simd_link_words;
  int32_t *const at[3] = {s->x, s->y, s->z};
  const lanes i[3] = {spring_lanes_load_i(p, s->x), spring_lanes_load_i(p, s->y),
                      spring_lanes_load_i(p, s->z)};
  const lanes j[3] = {spring_lanes_load_j(p, s->x), spring_lanes_load_j(p, s->y),
                      spring_lanes_load_j(p, s->z)};
  const lanes d[3] = {lanes_sub(j[0], i[0]), lanes_sub(j[1], i[1]), lanes_sub(j[2], i[2])};
  if (strain_limit_lanes_far(v, d)) return;
  const lanes hi[3] = {strain_limit_lanes_coarse(d[0], k), strain_limit_lanes_coarse(d[1], k),
                       strain_limit_lanes_coarse(d[2], k)};
  const lanes n = strain_limit_lanes_squared(
      d, hi, strain_limit_lanes_word(v, p, STRAIN_LIMIT_LANES_N_MAX, &s->classes->n_max));
  lanes f = strain_limit_lanes_factor(v, n, p, k);
  const int half_mass = spring_lanes_any_half_mass(p);
  if (half_mass) f = strain_limit_lanes_two_thirds(p, f);
  LANES_UNROLL_3
  for (int a = 0; a < 3; ++a) {
    const lanes c = strain_limit_lanes_step(hi[a], f, k);
    spring_lanes_store_i(p, at[a],
                         lanes_add(i[a], half_mass ? spring_lanes_by_mass(p, c, SPRING_HALF_I) : c));
    spring_lanes_store_j(p, at[a],
                         lanes_sub(j[a], half_mass ? spring_lanes_by_mass(p, c, SPRING_HALF_J) : c));
  }
}

#ifdef LANES_GROUPS
LANES_INLINE void strain_limit_lanes_way(const link_view *s, uint32_t i, uint32_t j, lanes d[3]) {
  int32_t *const at[3] = {s->x, s->y, s->z};
  LANES_UNROLL_3
  for (int a = 0; a < 3; ++a) d[a] = lanes_sub(lanes_load(at[a] + j), lanes_load(at[a] + i));
}

/* `count` groups: `one` is common to all, i and j are their first particles. */
LANES_INLINE void strain_limit_lanes_each(const strain_limit_lanes_view *v, const spring_lanes *one,
                                          const index_t *first_i, const index_t *first_j, uint32_t count) {
  const link_view *s = &v->at;
  const link_words *k = &simd_link_words;
  int32_t *const at[3] = {s->x, s->y, s->z};
  const lanes n_max = spring_lanes_class(one, &s->classes->n_max, LINK_CLASS_WORDS);
  lanes hi[LANES_GROUPS][3];
  lanes f[LANES_GROUPS];
  for (uint32_t g = 0; g < count; ++g) {
    lanes d[3];
    strain_limit_lanes_way(s, first_i[g], first_j[g], d);
    LANES_UNROLL_3
    for (int a = 0; a < 3; ++a) hi[g][a] = strain_limit_lanes_coarse(d[a], k);
    f[g] = strain_limit_lanes_squared(d, hi[g], n_max);
  }
  for (uint32_t g = 0; g < count; ++g) f[g] = strain_limit_lanes_factor(v, f[g], one, k);
  for (uint32_t g = 0; g < count; ++g) {
    LANES_UNROLL_3
    for (int a = 0; a < 3; ++a) {
      const lanes c = strain_limit_lanes_step(hi[g][a], f[g], k);
      int32_t *i = at[a] + first_i[g];
      int32_t *j = at[a] + first_j[g];
      lanes_store(i, lanes_add(lanes_load(i), c));
      lanes_store(j, lanes_sub(lanes_load(j), c));
    }
  }
}

/* Those of diagonals that may be too short. */
LANES_INLINE void strain_limit_lanes_short(const strain_limit_lanes_view *v, const spring_groups *m) {
  index_t i[LANES_GROUPS];
  index_t j[LANES_GROUPS];
  uint32_t count = 0;
  for (uint32_t g = 0; g < m->count; ++g) {
    lanes d[3];
    strain_limit_lanes_way(&v->at, m->i[g], m->j[g], d);
    i[count] = m->i[g];
    j[count] = m->j[g];
    count += strain_limit_lanes_far(v, d) ? 0u : 1u;
  }
  strain_limit_lanes_each(v, &m->one, i, j, count);
}

/* Nearly all are full: compilers unroll the constant count. */
LANES_INLINE void strain_limit_lanes_groups(const void *view, const spring_groups *m) {
  const strain_limit_lanes_view *v = (const strain_limit_lanes_view *)view;
  if (v->at.is_lock)
    strain_limit_lanes_short(v, m);
  else if (m->count == LANES_GROUPS)
    strain_limit_lanes_each(v, &m->one, m->i, m->j, LANES_GROUPS);
  else
    strain_limit_lanes_each(v, &m->one, m->i, m->j, m->count);
}
#else
#define strain_limit_lanes_groups NULL
#endif

LANES_INLINE uint32_t strain_limit_lanes_run(link_view s, const spring_batch *batches, uint32_t count) {
  const spring_rows rows = {s.i, s.j, s.kind};
  const int32_t far = s.is_lock ? lock_far(&s.classes[CLASS_SHEAR]) : 0;
  strain_limit_lanes_view v = {s, far, 0, {{0}}};
  strain_limit_lanes_fill(&v);
  return spring_lanes_batches(&rows, batches, count, strain_limit_lanes_pairs, strain_limit_lanes_groups,
                              &v);
}

#endif
