/* SPDX-License-Identifier: Apache-2.0 */
/* What moves as one in a tick, where a sheet meets itself (after the zones of Bridson et al. 2002, without
 * turning): particles on their straight ways of the tick, and groups of them that go by their mean, from where
 * the tick began. Used by selves.c for yarns and by layers.c for triangles. */
#ifndef FRAY_STAGE_ZONES_H
#define FRAY_STAGE_ZONES_H

#include "rt/model/world.h"

/* Everyone for himself; ways end where particles are now. */
void zones_begin(fray_world *w);
uint32_t zones_of(fray_world *w, uint32_t particle);
void zones_join(fray_world *w, uint32_t p, uint32_t q);
/* All of a zone by its mean, or as the body moves that holds some of it, or beside which some of it stands.
 * Positions alone: nobody gets a speed by it. Cost: linear in the particles. */
void zones_move(fray_world *w);
/* 1 iff nobody is farther from where his way ended than the slack, along an axis. */
int zones_stay(const fray_world *w);
/* Of triangles: what moves as one goes on as one, at the mean of its speeds. Momentum is the same afterwards to the
 * last bit. */
void zones_slow(fray_world *w);
/* The whole sheet; said as a fault. */
void zones_join_all(fray_world *w);

/* Products for what is done to all that is near each other: inline. */
static inline int64_t zones_dot(vec3 a, vec3 b) {
  return fx_add64(fx_add64(fx_mul_wide(a.x, b.x), fx_mul_wide(a.y, b.y)), fx_mul_wide(a.z, b.z));
}
static inline int64_t zones_along(vec3 from, vec3 to, vec3 way) { return zones_dot(vec_sub(to, from), way); }
/* At least its length: right for (1, 0, 0), (1, 1, 0), (1, 1, 1), and convex. Components to 2^29. */
static inline int32_t zones_length(vec3 v) {
  const int32_t x = (int32_t)fx_magnitude(v.x);
  const int32_t y = (int32_t)fx_magnitude(v.y);
  const int32_t z = (int32_t)fx_magnitude(v.z);
  return fx_max(fx_max(x, y), z) / 2 + (x + y + z) / 2 + 2;
}

#endif
