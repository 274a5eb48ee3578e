/* SPDX-License-Identifier: Apache-2.0 */
/* Random pairs of moving edges, and of a point and a triangle, by families: p[0..1] and p[2..3], or
 * p[0] and p[1..3]. Most families make what is degenerate often: parallel, flat, in a plane, or
 * touching to within a step of position. */
#ifndef FRAY_TESTS_ORACLE_PAIRS_H
#define FRAY_TESTS_ORACLE_PAIRS_H

#include "rt/base/sweep.h"

static uint64_t pairs_seed = 0x2545F4914F6CDD1Du;
static inline uint64_t pairs_next(void) {
  uint64_t v = pairs_seed += 0x9E3779B97F4A7C15u;
  v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9u;
  v = (v ^ (v >> 27)) * 0x94D049BB133111EBu;
  return v ^ (v >> 31);
}
/* -most..most */
static inline int32_t upto(int32_t most) {
  return (int32_t)(pairs_next() % (2u * (uint64_t)most + 1u)) - most;
}
static inline uint32_t pairs_below(uint32_t n) { return (uint32_t)(pairs_next() % n); }
static inline int32_t hold(int64_t v) {
  return (int32_t)fx_clamp64(v, -FX_WORLD_MAX, FX_WORLD_MAX);
}

static inline vec3 anywhere(int32_t most) {
  vec3 v;
  v.x = upto(most);
  v.y = upto(most);
  v.z = upto(most);
  return v;
}
static inline vec3 plus(vec3 a, vec3 b, int32_t times) {
  return vec_make(hold(a.x + (int64_t)times * b.x), hold(a.y + (int64_t)times * b.y),
                  hold(a.z + (int64_t)times * b.z));
}
static inline vec3 plus_all(vec3 a, vec3 b) { return plus(a, b, 1); }

/* A size from 1 to the world's, each power of two alike. */
static inline int32_t any_size(void) {
  const int32_t size = (int32_t)1 << pairs_below(30);
  return (int32_t)fx_clamp64((int64_t)size + pairs_below((uint32_t)size), 1, FX_WORLD_MAX);
}

typedef void family(sweep_point p[4], int triangle);

static inline void moved_by(sweep_point p[4], int32_t most) {
  for (uint32_t n = 0; n < 4; ++n) p[n].end = plus_all(p[n].begin, anywhere(most));
}

static inline void uniform(sweep_point p[4], int triangle) {
  const int32_t size = any_size();
  (void)triangle;
  for (uint32_t n = 0; n < 4; ++n) {
    p[n].begin = anywhere(size);
    p[n].end = anywhere(size);
  }
}
/* Edges of 1/12 lu near each other that move by some hundredths of it, as in a substep. */
static inline void cloth(sweep_point p[4], int triangle) {
  const vec3 centre = anywhere(50 * FX_LU);
  (void)triangle;
  for (uint32_t n = 0; n < 4; ++n) p[n].begin = plus_all(centre, anywhere(FX_LU / 16));
  moved_by(p, FX_LU / 400);
}
/* The same in hard motion: all move together by much, apart by as much as the size. */
static inline void thrown(sweep_point p[4], int triangle) {
  const vec3 way_of_all = anywhere(FX_LU * 2);
  cloth(p, triangle);
  for (uint32_t n = 0; n < 4; ++n)
    p[n].end = plus_all(plus_all(p[n].begin, way_of_all), anywhere(FX_LU / 16));
}
static inline void lattice(sweep_point p[4], int triangle) {
  const int32_t most = 1 + (int32_t)pairs_below(3);
  (void)triangle;
  for (uint32_t n = 0; n < 4; ++n) {
    p[n].begin = anywhere(most);
    p[n].end = anywhere(most);
  }
}
static inline void large_lattice(sweep_point p[4], int triangle) {
  const int32_t unit = FX_WORLD_MAX / 3;
  lattice(p, triangle);
  for (uint32_t n = 0; n < 4; ++n) {
    p[n].begin = plus(vec_make(0, 0, 0), p[n].begin, unit);
    p[n].end = plus(vec_make(0, 0, 0), p[n].end, unit);
    if (pairs_below(2) == 0) p[n].end = plus_all(p[n].end, anywhere(1));
  }
}
static inline void in_a_plane(sweep_point p[4], int triangle) {
  const int32_t size = pairs_below(2) == 0 ? any_size() : 3;
  const int32_t height_begin = upto(size);
  const int32_t height_end = upto(size);
  (void)triangle;
  for (uint32_t n = 0; n < 4; ++n) {
    p[n].begin = anywhere(size);
    p[n].end = anywhere(size);
    p[n].begin.z = height_begin;
    p[n].end.z = height_end;
  }
}
/* Edges that stay parallel; a point that stays in the plane of a triangle, or above it. */
static inline void parallel(sweep_point p[4], int triangle) {
  const int32_t size = any_size() / 16 + 1;
  const vec3 along = anywhere(size);
  const vec3 other = triangle ? anywhere(size) : along;
  for (uint32_t n = 0; n < 2; ++n) {
    vec3 *at[4];
    for (uint32_t k = 0; k < 4; ++k) at[k] = n == 0 ? &p[k].begin : &p[k].end;
    *at[0] = anywhere(pairs_below(2) == 0 ? size : 1);
    *at[1] = triangle ? plus(*at[0], along, upto(2)) : plus(*at[0], along, upto(3));
    *at[2] = anywhere(pairs_below(2) == 0 ? size : 1);
    if (pairs_below(2) == 0) *at[2] = plus(*at[0], along, upto(3));
    *at[3] = plus(*at[2], other, upto(3));
    if (pairs_below(4) == 0) *at[3] = plus_all(*at[3], anywhere(1));
  }
}
/* Edges of length 0, triangles of area 0 and points. */
static inline void flat(sweep_point p[4], int triangle) {
  if (pairs_below(2) == 0)
    lattice(p, triangle);
  else
    uniform(p, triangle);
  const uint32_t same = pairs_below(4);
  if (same != 0) p[3] = p[2];
  if (same == 1) p[1] = p[triangle ? 2 : 0];
  if (same == 2) {
    p[1].begin = plus(p[2].begin, vec_sub(vec_make(1, 1, 1), vec_make(0, 0, 0)), upto(3));
    p[1].end = plus(p[2].end, vec_make(1, 1, 1), upto(3));
  }
}

/* Four points that touch: both edges through x, or the point x in the triangle. Then each is moved
 * by one step in one of two. */
static inline void at_once(vec3 at[4], int triangle, int32_t size) {
  const vec3 x = anywhere(size);
  const vec3 a = anywhere(size / 4 + 1);
  const vec3 b = anywhere(size / 4 + 1);
  if (triangle) {
    const int32_t u = (int32_t)pairs_below(4);
    const int32_t v = (int32_t)pairs_below(4);
    at[0] = x;
    at[1] = plus(x, a, u);
    at[2] = plus(x, b, v);
    at[3] = plus(plus(x, a, -1), b, -1);
  } else {
    at[0] = plus(x, a, (int32_t)pairs_below(4));
    at[1] = plus(x, a, -(int32_t)pairs_below(4));
    at[2] = plus(x, b, (int32_t)pairs_below(4));
    at[3] = plus(x, b, -(int32_t)pairs_below(4));
  }
  if (pairs_below(2) == 0) return;
  const uint32_t n = pairs_below(4);
  at[n] = plus_all(at[n], anywhere(1));
}
static inline void touch_then(sweep_point p[4], int triangle, int at_end) {
  const int32_t size = pairs_below(4) == 0 ? 2 : any_size() / 4 + 1;
  const int32_t way_of_all = pairs_below(2) == 0 ? size : size / 64 + 1;
  vec3 at[4];
  at_once(at, triangle, size);
  for (uint32_t n = 0; n < 4; ++n) {
    const vec3 other = plus_all(at[n], anywhere(way_of_all));
    p[n].begin = at_end ? other : at[n];
    p[n].end = at_end ? at[n] : other;
  }
}
static inline void touch_at_begin(sweep_point p[4], int triangle) { touch_then(p, triangle, 0); }
static inline void touch_at_end(sweep_point p[4], int triangle) { touch_then(p, triangle, 1); }
/* Halfway: begin = middle - d, end = middle + d, which holds the middle for any d. */
static inline void touch_halfway(sweep_point p[4], int triangle) {
  const int32_t size = pairs_below(4) == 0 ? 2 : any_size() / 8 + 1;
  const int32_t way_of_all = pairs_below(2) == 0 ? size : size / 64 + 1;
  vec3 at[4];
  at_once(at, triangle, size);
  for (uint32_t n = 0; n < 4; ++n) {
    const vec3 d = anywhere(way_of_all);
    p[n].begin = plus(at[n], d, -1);
    p[n].end = plus(at[n], d, 1);
  }
}
/* Edges that have an end in common all the time, or part; a point that is a corner. */
static inline void chained(sweep_point p[4], int triangle) {
  uniform(p, triangle);
  p[2] = p[triangle ? 0 : 1];
  const uint32_t kind = pairs_below(3);
  if (kind == 0) p[2].begin = plus_all(p[2].begin, anywhere(1));
  if (kind == 1) p[2].end = plus_all(p[2].end, anywhere(1));
}
/* An edge that turns round while the other all but stands: it passes by ends. */
static inline void grazing(sweep_point p[4], int triangle) {
  const int32_t size = any_size() / 64 + 8;
  const vec3 centre = anywhere(FX_WORLD_MAX / 2);
  (void)triangle;
  for (uint32_t n = 0; n < 4; ++n) p[n].begin = plus_all(centre, anywhere(size));
  moved_by(p, size);
  p[0].end = plus_all(p[1].begin, anywhere(2));
  p[1].end = plus_all(p[0].begin, anywhere(2));
  p[3].end = plus_all(p[3].begin, anywhere(2));
  p[2].end = plus_all(p[2].begin, anywhere(2));
}
static inline void edges_of_the_world(sweep_point p[4], int triangle) {
  (void)triangle;
  for (uint32_t n = 0; n < 24; ++n) {
    const uint32_t kind = pairs_below(6);
    const int32_t v = kind < 2 ? FX_WORLD_MAX - (int32_t)pairs_below(3)
                               : (kind < 4 ? -FX_WORLD_MAX + (int32_t)pairs_below(3)
                                           : (kind == 4 ? upto(2) : upto(FX_WORLD_MAX)));
    vec3 *at = n < 12 ? &p[n / 3].begin : &p[(n - 12) / 3].end;
    int32_t *to[3] = {&at->x, &at->y, &at->z};
    *to[n % 3] = v;
  }
}

/* A triangle or an edge of a rigid mesh that moves as a whole, and cloth that comes down on it. */
static inline void rigid(sweep_point p[4], int triangle) {
  const int32_t size = (int32_t)1 << (12 + pairs_below(16));
  const vec3 centre = anywhere(30 * FX_LU);
  const vec3 way_of_all = anywhere(size / 4);
  const uint32_t fixed = triangle ? 1 : 2;
  for (uint32_t n = 0; n < 4; ++n) {
    p[n].begin = plus_all(centre, anywhere(n < fixed ? size / 2 : size));
    p[n].end = n < fixed ? plus_all(p[n].begin, anywhere(size)) : plus_all(p[n].begin, way_of_all);
  }
}

typedef struct {
  const char *name;
  family *make;
  uint32_t edges, points; /* pairs that a test takes */
} family_row;

static const family_row families[] = {
    {"uniform", uniform, 150000, 300000},
    {"cloth", cloth, 200000, 400000},
    {"thrown", thrown, 150000, 300000},
    {"lattice", lattice, 20000, 20000},
    {"large_lattice", large_lattice, 20000, 20000},
    {"in_a_plane", in_a_plane, 10000, 10000},
    {"parallel", parallel, 20000, 20000},
    {"flat", flat, 20000, 20000},
    {"touch_at_begin", touch_at_begin, 20000, 20000},
    {"touch_at_end", touch_at_end, 20000, 20000},
    {"touch_halfway", touch_halfway, 20000, 20000},
    {"chained", chained, 20000, 20000},
    {"grazing", grazing, 20000, 20000},
    {"edges_of_the_world", edges_of_the_world, 20000, 20000},
    {"rigid", rigid, 50000, 100000},
};
enum { FAMILIES = sizeof families / sizeof families[0] };

static inline int sweep_pair(const sweep_point p[4], int triangle, int32_t thickness,
                             sweep_contact *c) {
  return triangle ? sweep_point_triangle(&p[0], &p[1], thickness, c)
                  : sweep_edges(&p[0], &p[2], thickness, c);
}

#endif
