/* SPDX-License-Identifier: Apache-2.0 */
/* Which particles may come near a body before a tick ends: stage/collide.c gathers them. */
#ifndef FRAY_WIDE_REACH_H
#define FRAY_WIDE_REACH_H

#include "rt/base/vec.h"

/* A box around a body, widened by skin and travel; a reach of the world's width reaches everything. */
typedef struct {
  int32_t centre[3];
  uint32_t half[3];
  vec3 normal;      /* of a plane instead, Q30, and how far above it counts as near */
  int64_t above;
  uint32_t substeps;
  uint32_t fastest; /* the speed, in steps of a position, that crosses the world in a tick */
} reach;

/* How far something gets in this tick: speed * substeps, at most the world's half. */
static inline uint32_t reach_travel(int32_t velocity, uint32_t substeps, uint32_t fastest) {
  const uint32_t speed = fx_magnitude(velocity) >> FX_SUB_BITS;
  return speed > fastest ? (uint32_t)FX_WORLD_MAX : speed * substeps;
}

/* The distance is below 2^31, the sum below 2^32. */
static inline int reach_along(const reach *g, uint32_t n, int32_t at, int32_t velocity) {
  return fx_magnitude(fx_sub(at, g->centre[n])) <=
         g->half[n] + reach_travel(velocity, g->substeps, g->fastest);
}

/* Whether any of the particles first..end-1 may; their coordinates and velocities by axis. */
static inline uint32_t reach_any(const reach *g, const int32_t *restrict x,
                                 const int32_t *restrict y, const int32_t *restrict z,
                                 const int32_t *restrict vx, const int32_t *restrict vy,
                                 const int32_t *restrict vz, uint32_t first, uint32_t end) {
  const reach box = *g;
  uint32_t any = 0;
  for (uint32_t p = first; p < end; ++p)
    any |= (uint32_t)(reach_along(&box, 0, x[p], vx[p]) & reach_along(&box, 1, y[p], vy[p]) &
                      reach_along(&box, 2, z[p], vz[p]));
  return any;
}

static inline int reach_above(const reach *g, vec3 at, vec3 v) {
  const vec3 away = vec_make(fx_sub(at.x, g->centre[0]), fx_sub(at.y, g->centre[1]),
                             fx_sub(at.z, g->centre[2]));
  const int64_t way = (int64_t)reach_travel(v.x, g->substeps, g->fastest) +
                      reach_travel(v.y, g->substeps, g->fastest) +
                      reach_travel(v.z, g->substeps, g->fastest);
  return vec_dot_unit(away, g->normal) <= g->above + way;
}

static inline uint32_t reach_any_above(const reach *g, const int32_t *restrict x,
                                       const int32_t *restrict y, const int32_t *restrict z,
                                       const int32_t *restrict vx, const int32_t *restrict vy,
                                       const int32_t *restrict vz, uint32_t first, uint32_t end) {
  const reach plane = *g;
  uint32_t any = 0;
  for (uint32_t p = first; p < end; ++p)
    any |= (uint32_t)reach_above(&plane, vec_make(x[p], y[p], z[p]), vec_make(vx[p], vy[p], vz[p]));
  return any;
}

#endif
