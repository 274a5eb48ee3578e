/* SPDX-License-Identifier: Apache-2.0 */
/* Random pairs of moving edges, and of a point and a triangle, by families: p[0..1] and p[2..3], or
 * p[0] and p[1..3]. Most families make what is degenerate often: parallel, flat, in a plane, or
 * touching to within a step of position. */
#ifndef FRAY_TESTS_PHYSICS_MOVING_PAIRS_H
#define FRAY_TESTS_PHYSICS_MOVING_PAIRS_H

#include "rt/geometry/ccd.h"
#include "tests/lib/splitmix64.h"

static uint64_t pairs_seed = 0x2545F4914F6CDD1Du;
/* -most..most */
static inline int32_t random_up_to(int32_t most) {
  return (int32_t)(splitmix64(&pairs_seed) % (2u * (uint64_t)most + 1u)) - most;
}
static inline uint32_t pairs_below(uint32_t n) { return (uint32_t)(splitmix64(&pairs_seed) % n); }
static inline int32_t clamp_to_world(int64_t v) {
  return (int32_t)fx_clamp64(v, -FX_WORLD_MAX, FX_WORLD_MAX);
}

static inline vec3 random_vec(int32_t most) {
  vec3 v;
  v.x = random_up_to(most);
  v.y = random_up_to(most);
  v.z = random_up_to(most);
  return v;
}
static inline vec3 add_scaled(vec3 a, vec3 b, int32_t times) {
  return vec_make(clamp_to_world(a.x + (int64_t)times * b.x), clamp_to_world(a.y + (int64_t)times * b.y),
                  clamp_to_world(a.z + (int64_t)times * b.z));
}
static inline vec3 add_clamped(vec3 a, vec3 b) { return add_scaled(a, b, 1); }

/* A size from 1 to the world's, each power of two alike. */
static inline int32_t random_size(void) {
  const int32_t size = (int32_t)1 << pairs_below(30);
  return (int32_t)fx_clamp64((int64_t)size + pairs_below((uint32_t)size), 1, FX_WORLD_MAX);
}

typedef void family(ccd_path p[4], int triangle);

static inline void moved_by(ccd_path p[4], int32_t most) {
  for (uint32_t n = 0; n < 4; ++n) p[n].end = add_clamped(p[n].begin, random_vec(most));
}

static inline void uniform(ccd_path p[4], int triangle) {
  const int32_t size = random_size();
  (void)triangle;
  for (uint32_t n = 0; n < 4; ++n) {
    p[n].begin = random_vec(size);
    p[n].end = random_vec(size);
  }
}
/* Edges of 1/12 lu near each other that move by some hundredths of it, as in a substep. */
static inline void cloth(ccd_path p[4], int triangle) {
  const vec3 centre = random_vec(50 * FX_LU);
  (void)triangle;
  for (uint32_t n = 0; n < 4; ++n) p[n].begin = add_clamped(centre, random_vec(FX_LU / 16));
  moved_by(p, FX_LU / 400);
}
/* The same in hard motion: all move together by much, apart by as much as the size. */
static inline void thrown(ccd_path p[4], int triangle) {
  const vec3 way_of_all = random_vec(FX_LU * 2);
  cloth(p, triangle);
  for (uint32_t n = 0; n < 4; ++n)
    p[n].end = add_clamped(add_clamped(p[n].begin, way_of_all), random_vec(FX_LU / 16));
}
static inline void lattice(ccd_path p[4], int triangle) {
  const int32_t most = 1 + (int32_t)pairs_below(3);
  (void)triangle;
  for (uint32_t n = 0; n < 4; ++n) {
    p[n].begin = random_vec(most);
    p[n].end = random_vec(most);
  }
}
static inline void large_lattice(ccd_path p[4], int triangle) {
  const int32_t unit = FX_WORLD_MAX / 3;
  lattice(p, triangle);
  for (uint32_t n = 0; n < 4; ++n) {
    p[n].begin = add_scaled(vec_make(0, 0, 0), p[n].begin, unit);
    p[n].end = add_scaled(vec_make(0, 0, 0), p[n].end, unit);
    if (pairs_below(2) == 0) p[n].end = add_clamped(p[n].end, random_vec(1));
  }
}
static inline void in_a_plane(ccd_path p[4], int triangle) {
  const int32_t size = pairs_below(2) == 0 ? random_size() : 3;
  const int32_t height_begin = random_up_to(size);
  const int32_t height_end = random_up_to(size);
  (void)triangle;
  for (uint32_t n = 0; n < 4; ++n) {
    p[n].begin = random_vec(size);
    p[n].end = random_vec(size);
    p[n].begin.z = height_begin;
    p[n].end.z = height_end;
  }
}
/* Edges that stay parallel; a point that stays in the plane of a triangle, or above it. */
static inline void parallel(ccd_path p[4], int triangle) {
  const int32_t size = random_size() / 16 + 1;
  const vec3 along = random_vec(size);
  const vec3 other = triangle ? random_vec(size) : along;
  for (uint32_t n = 0; n < 2; ++n) {
    vec3 *at[4];
    for (uint32_t k = 0; k < 4; ++k) at[k] = n == 0 ? &p[k].begin : &p[k].end;
    *at[0] = random_vec(pairs_below(2) == 0 ? size : 1);
    *at[1] = triangle ? add_scaled(*at[0], along, random_up_to(2)) : add_scaled(*at[0], along, random_up_to(3));
    *at[2] = random_vec(pairs_below(2) == 0 ? size : 1);
    if (pairs_below(2) == 0) *at[2] = add_scaled(*at[0], along, random_up_to(3));
    *at[3] = add_scaled(*at[2], other, random_up_to(3));
    if (pairs_below(4) == 0) *at[3] = add_clamped(*at[3], random_vec(1));
  }
}
/* Edges of length 0, triangles of area 0 and points. */
static inline void flat(ccd_path p[4], int triangle) {
  if (pairs_below(2) == 0)
    lattice(p, triangle);
  else
    uniform(p, triangle);
  const uint32_t same = pairs_below(4);
  if (same != 0) p[3] = p[2];
  if (same == 1) p[1] = p[triangle ? 2 : 0];
  if (same == 2) {
    p[1].begin = add_scaled(p[2].begin, vec_sub(vec_make(1, 1, 1), vec_make(0, 0, 0)), random_up_to(3));
    p[1].end = add_scaled(p[2].end, vec_make(1, 1, 1), random_up_to(3));
  }
}

/* Four points that touch: both edges through x, or the point x in the triangle. Then each is moved
 * by one step in one of two. */
static inline void at_once(vec3 at[4], int triangle, int32_t size) {
  const vec3 x = random_vec(size);
  const vec3 a = random_vec(size / 4 + 1);
  const vec3 b = random_vec(size / 4 + 1);
  if (triangle) {
    const int32_t u = (int32_t)pairs_below(4);
    const int32_t v = (int32_t)pairs_below(4);
    at[0] = x;
    at[1] = add_scaled(x, a, u);
    at[2] = add_scaled(x, b, v);
    at[3] = add_scaled(add_scaled(x, a, -1), b, -1);
  } else {
    at[0] = add_scaled(x, a, (int32_t)pairs_below(4));
    at[1] = add_scaled(x, a, -(int32_t)pairs_below(4));
    at[2] = add_scaled(x, b, (int32_t)pairs_below(4));
    at[3] = add_scaled(x, b, -(int32_t)pairs_below(4));
  }
  if (pairs_below(2) == 0) return;
  const uint32_t n = pairs_below(4);
  at[n] = add_clamped(at[n], random_vec(1));
}
static inline void touch_then(ccd_path p[4], int triangle, int at_end) {
  const int32_t size = pairs_below(4) == 0 ? 2 : random_size() / 4 + 1;
  const int32_t way_of_all = pairs_below(2) == 0 ? size : size / 64 + 1;
  vec3 at[4];
  at_once(at, triangle, size);
  for (uint32_t n = 0; n < 4; ++n) {
    const vec3 other = add_clamped(at[n], random_vec(way_of_all));
    p[n].begin = at_end ? other : at[n];
    p[n].end = at_end ? at[n] : other;
  }
}
static inline void touch_at_begin(ccd_path p[4], int triangle) { touch_then(p, triangle, 0); }
static inline void touch_at_end(ccd_path p[4], int triangle) { touch_then(p, triangle, 1); }
/* Halfway: begin = middle - d, end = middle + d, which holds the middle for any d. */
static inline void touch_halfway(ccd_path p[4], int triangle) {
  const int32_t size = pairs_below(4) == 0 ? 2 : random_size() / 8 + 1;
  const int32_t way_of_all = pairs_below(2) == 0 ? size : size / 64 + 1;
  vec3 at[4];
  at_once(at, triangle, size);
  for (uint32_t n = 0; n < 4; ++n) {
    const vec3 d = random_vec(way_of_all);
    p[n].begin = add_scaled(at[n], d, -1);
    p[n].end = add_scaled(at[n], d, 1);
  }
}
/* Edges that have an end in common all the time, or part; a point that is a corner. */
static inline void chained(ccd_path p[4], int triangle) {
  uniform(p, triangle);
  p[2] = p[triangle ? 0 : 1];
  const uint32_t kind = pairs_below(3);
  if (kind == 0) p[2].begin = add_clamped(p[2].begin, random_vec(1));
  if (kind == 1) p[2].end = add_clamped(p[2].end, random_vec(1));
}
/* An edge that turns round while the other all but stands: it passes by ends. */
static inline void grazing(ccd_path p[4], int triangle) {
  const int32_t size = random_size() / 64 + 8;
  const vec3 centre = random_vec(FX_WORLD_MAX / 2);
  (void)triangle;
  for (uint32_t n = 0; n < 4; ++n) p[n].begin = add_clamped(centre, random_vec(size));
  moved_by(p, size);
  p[0].end = add_clamped(p[1].begin, random_vec(2));
  p[1].end = add_clamped(p[0].begin, random_vec(2));
  p[3].end = add_clamped(p[3].begin, random_vec(2));
  p[2].end = add_clamped(p[2].begin, random_vec(2));
}
static inline void edges_of_the_world(ccd_path p[4], int triangle) {
  (void)triangle;
  for (uint32_t n = 0; n < 24; ++n) {
    const uint32_t kind = pairs_below(6);
    const int32_t v = kind < 2 ? FX_WORLD_MAX - (int32_t)pairs_below(3)
                               : (kind < 4 ? -FX_WORLD_MAX + (int32_t)pairs_below(3)
                                           : (kind == 4 ? random_up_to(2) : random_up_to(FX_WORLD_MAX)));
    vec3 *at = n < 12 ? &p[n / 3].begin : &p[(n - 12) / 3].end;
    int32_t *to[3] = {&at->x, &at->y, &at->z};
    *to[n % 3] = v;
  }
}

/* A triangle or an edge of a rigid mesh that moves as a whole, and cloth that comes down on it. */
static inline void rigid(ccd_path p[4], int triangle) {
  const int32_t size = (int32_t)1 << (12 + pairs_below(16));
  const vec3 centre = random_vec(30 * FX_LU);
  const vec3 way_of_all = random_vec(size / 4);
  const uint32_t fixed = triangle ? 1 : 2;
  for (uint32_t n = 0; n < 4; ++n) {
    p[n].begin = add_clamped(centre, random_vec(n < fixed ? size / 2 : size));
    p[n].end = n < fixed ? add_clamped(p[n].begin, random_vec(size)) : add_clamped(p[n].begin, way_of_all);
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

static inline int ccd_of_pair(const ccd_path p[4], int triangle, int32_t thickness,
                             ccd_contact *c) {
  return triangle ? ccd_point_triangle(&p[0], &p[1], thickness, c)
                  : ccd_edges(&p[0], &p[2], thickness, c);
}

#endif
