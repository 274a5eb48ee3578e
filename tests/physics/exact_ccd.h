/* SPDX-License-Identifier: Apache-2.0 */
/* Whether two moving edges, or a moving point and a moving triangle, touch at some t in [0, 1]:
 * decided exactly. What touches from some time on does so from t = 0 on or from a root of
 * a polynomial of which the test at one time asks the sign; so the test is made at 0, at 1 and at
 * those roots. */
#ifndef FRAY_TESTS_PHYSICS_EXACT_CCD_H
#define FRAY_TESTS_PHYSICS_EXACT_CCD_H

#include "tests/physics/polynomial_roots.h"

/* A point on its straight way, |coordinates| below 2^61. */
typedef struct {
  int64_t begin[3], end[3];
} moving_point;

typedef struct {
  poly x[3];
} poly3;

static inline void poly3_between(poly3 *v, const moving_point *from, const moving_point *to) {
  for (uint32_t n = 0; n < 3; ++n)
    poly_line(&v->x[n], to->begin[n] - from->begin[n], to->end[n] - from->end[n]);
}
static inline void poly3_cross(poly3 *to, const poly3 *a, const poly3 *b) {
  static poly one, other;
  for (uint32_t n = 0; n < 3; ++n) {
    poly_multiply(&one, &a->x[(n + 1u) % 3u], &b->x[(n + 2u) % 3u]);
    poly_multiply(&other, &a->x[(n + 2u) % 3u], &b->x[(n + 1u) % 3u]);
    poly_sum(&to->x[n], &one, &other, 1);
  }
}
static inline void poly3_dot(poly *to, const poly3 *a, const poly3 *b) {
  static poly part;
  to->degree = -1;
  for (uint32_t n = 0; n < 3; ++n) {
    poly_multiply(&part, &a->x[n], &b->x[n]);
    poly_sum(to, to, &part, 0);
  }
}

/* A point on an edge: cross is 0 in all three and `along` is at most 0. */
typedef struct {
  poly3 cross;
  poly along;
} on_edge;

static inline void on_edge_make(on_edge *o, const moving_point *p, const moving_point *a, const moving_point *b) {
  static poly3 edge, to_p, to_a, to_b;
  poly3_between(&edge, a, b);
  poly3_between(&to_p, a, p);
  poly3_cross(&o->cross, &edge, &to_p);
  poly3_between(&to_a, p, a);
  poly3_between(&to_b, p, b);
  poly3_dot(&o->along, &to_a, &to_b);
}
static inline int zero_at(const poly3 *v, const root *at) {
  return sign_at(&v->x[0], at) == 0 && sign_at(&v->x[1], at) == 0 && sign_at(&v->x[2], at) == 0;
}
static inline int on_edge_at(const on_edge *o, const root *at) {
  return zero_at(&o->cross, at) && sign_at(&o->along, at) <= 0;
}

/* All that the tests at one time ask about. In the plane of a normal that is not 0: for edges sides
 * 0 and 1 are those of the second edge's ends against the first edge, 2 and 3 the others; for
 * a triangle sides 0 to 2 are those of the point against its edges. Else: points on edges. */
typedef struct {
  int triangle;
  poly volume;
  poly3 normal;
  poly side[4];
  on_edge on[4];
} pair;

static inline void make_side(poly *to, const poly3 *normal, const moving_point *a, const moving_point *b,
                             const moving_point *p) {
  static poly3 edge, other, cross;
  poly3_between(&edge, a, b);
  poly3_between(&other, a, p);
  poly3_cross(&cross, &edge, &other);
  poly3_dot(to, normal, &cross);
}

/* p[0..1] and p[2..3] are the edges, or p[0] the point and p[1..3] the triangle. */
static inline void pair_begin(pair *q, const moving_point p[4], int triangle) {
  static poly3 one, other, apart;
  q->triangle = triangle;
  poly3_between(&one, triangle ? &p[1] : &p[0], triangle ? &p[2] : &p[1]);
  poly3_between(&other, triangle ? &p[1] : &p[2], &p[3]);
  poly3_between(&apart, &p[0], triangle ? &p[1] : &p[2]);
  poly3_cross(&q->normal, &one, &other);
  poly3_dot(&q->volume, &apart, &q->normal);
}
static inline void pair_end(pair *q, const moving_point p[4]) {
  const int on[2][4][3] = {{{0, 2, 3}, {1, 2, 3}, {2, 0, 1}, {3, 0, 1}},
                           {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {0, 3, 1}}};
  const int side[2][4][3] = {{{0, 1, 2}, {0, 1, 3}, {2, 3, 0}, {2, 3, 1}},
                             {{1, 2, 0}, {2, 3, 0}, {3, 1, 0}, {3, 1, 0}}};
  for (uint32_t n = 0; n < 4; ++n) {
    const int *s = side[q->triangle][n];
    const int *o = on[q->triangle][n];
    make_side(&q->side[n], &q->normal, &p[s[0]], &p[s[1]], &p[s[2]]);
    on_edge_make(&q->on[n], &p[o[0]], &p[o[1]], &p[o[2]]);
  }
}

static inline int touch_at(const pair *q, const root *at) {
  if (sign_at(&q->volume, at) != 0) return 0;
  if (zero_at(&q->normal, at)) {
    for (uint32_t n = 0; n < 4; ++n)
      if (on_edge_at(&q->on[n], at)) return 1;
    return 0;
  }
  if (q->triangle)
    return sign_at(&q->side[0], at) >= 0 && sign_at(&q->side[1], at) >= 0 &&
           sign_at(&q->side[2], at) >= 0;
  return sign_at(&q->side[0], at) * sign_at(&q->side[1], at) <= 0 &&
         sign_at(&q->side[2], at) * sign_at(&q->side[3], at) <= 0;
}
static inline int touch_at_roots(const pair *q, const poly *p) {
  static roots all;
  static poly copy;
  poly_copy(&copy, p);
  roots_of(&all, &copy);
  for (uint32_t n = 0; n < all.count; ++n)
    if (touch_at(q, &all.at[n])) return 1;
  return 0;
}

static inline int exact_ccd_touches(const moving_point p[4], int triangle) {
  static pair q;
  static root begin, end;
  begin.end = 0;
  end.end = 1;
  pair_begin(&q, p, triangle);
  if (q.volume.degree >= 0 && poly_variations(&q.volume) == 0 && poly_sign_zero(&q.volume) != 0 &&
      poly_sign_one(&q.volume) != 0)
    return 0;
  pair_end(&q, p);
  if (touch_at(&q, &begin) || touch_at(&q, &end)) return 1;
  if (q.volume.degree >= 0) return touch_at_roots(&q, &q.volume);
  for (uint32_t n = 0; n < 4; ++n) {
    if (touch_at_roots(&q, &q.side[n]) || touch_at_roots(&q, &q.on[n].along)) return 1;
    for (uint32_t k = 0; k < 3; ++k)
      if (touch_at_roots(&q, &q.on[n].cross.x[k])) return 1;
  }
  for (uint32_t k = 0; k < 3; ++k)
    if (touch_at_roots(&q, &q.normal.x[k])) return 1;
  return 0;
}

#endif
