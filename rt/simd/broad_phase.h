/* SPDX-License-Identifier: Apache-2.0 */
/* Which particles can come near a body before the tick ends; contact/contact_primitives.c gathers them. */
#ifndef FRAY_SIMD_BROAD_PHASE_H
#define FRAY_SIMD_BROAD_PHASE_H

#include "rt/base/vec.h"

/* A box around a body, widened by its skin and its travel in this tick, or a plane. */
typedef struct {
  int32_t centre[3]; /* Q24 lu, within +-FX_WORLD_MAX; of a plane: a point of it */
  uint32_t half[3];  /* half extents, Q24 lu, at most 2^31, which covers the world */
  vec3 normal;       /* of a plane, Q30 */
  int64_t above;     /* of a plane: the height up to which a particle is near, Q24 lu */
  uint32_t substeps; /* of a tick, at least 1 */
  uint32_t fastest;  /* Q24 lu per substep: FX_WORLD_MAX / substeps; what is faster may be anywhere */
} broad_phase;

/* How far a particle moves in this tick along an axis: speed * substeps, at most FX_WORLD_MAX. */
static inline uint32_t broad_phase_travel(int32_t velocity, uint32_t substeps, uint32_t fastest) {
  const uint32_t speed = fx_magnitude(velocity) >> FX_SUB_BITS;
  return speed > fastest ? (uint32_t)FX_WORLD_MAX : speed * substeps;
}

/* The distance is below 2^31, the sum below 2^32. */
static inline int broad_phase_near_axis(const broad_phase *g, uint32_t n, int32_t at, int32_t velocity) {
  return fx_magnitude(fx_sub(at, g->centre[n])) <=
         g->half[n] + broad_phase_travel(velocity, g->substeps, g->fastest);
}

static inline int broad_phase_near_plane(const broad_phase *g, vec3 at, vec3 v) {
  const vec3 away = vec_sub(at, vec_of(g->centre));
  const int64_t way = (int64_t)broad_phase_travel(v.x, g->substeps, g->fastest) +
                      broad_phase_travel(v.y, g->substeps, g->fastest) +
                      broad_phase_travel(v.z, g->substeps, g->fastest);
  return vec_dot_unit(away, g->normal) <= g->above + way;
}

/* Whether any of the particles first..end-1 can; positions in Q24 lu, velocities in Q28 lu per substep. */
static inline uint32_t broad_phase_any_near(int is_plane, const broad_phase *g, const int32_t *restrict x,
                                            const int32_t *restrict y, const int32_t *restrict z,
                                            const int32_t *restrict vx, const int32_t *restrict vy,
                                            const int32_t *restrict vz, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first <= end && g->substeps > 0);
  const broad_phase near = *g;
  uint32_t any = 0;
  if (is_plane)
    for (uint32_t p = first; p < end; ++p)
      any |= (uint32_t)broad_phase_near_plane(&near, vec_at(x, y, z, p), vec_at(vx, vy, vz, p));
  else
    for (uint32_t p = first; p < end; ++p)
      any |= (uint32_t)(broad_phase_near_axis(&near, 0, x[p], vx[p]) &
                        broad_phase_near_axis(&near, 1, y[p], vy[p]) &
                        broad_phase_near_axis(&near, 2, z[p], vz[p]));
  return any;
}

#endif
