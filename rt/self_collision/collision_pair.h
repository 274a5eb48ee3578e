/* SPDX-License-Identifier: Apache-2.0 */
/* Pairs of self-collision, as yarns and triangles have them alike: four particles, each on its straight
 * path of the tick. The first one (of a vertex) or two (of a segment or edge) are one part, the others
 * are the second part. */
#ifndef FRAY_SELF_COLLISION_COLLISION_PAIR_H
#define FRAY_SELF_COLLISION_COLLISION_PAIR_H

#include "rt/geometry/ccd.h"
#include "rt/state/world.h"

typedef struct {
  uint32_t p[4];
  ccd_path path[4]; /* from the start of the tick to the current position */
} collision_pair;

static inline ccd_path collision_pair_path(const fray_world *w, uint32_t p) {
  FRAY_ASSERT(p < w->p.count);
  const ccd_path path = {w->self.paths[p].begin, world_position(w, p)};
  return path;
}

static inline int64_t collision_pair_project(vec3 from, vec3 to, vec3 along) {
  return vec_dot64(vec_sub(to, from), along);
}
/* An upper bound of its length: exact for (1, 0, 0), (1, 1, 0) and (1, 1, 1), and convex. Components to
 * 2^29. */
static inline int32_t collision_pair_length(vec3 v) {
  const int32_t x = (int32_t)fx_magnitude(v.x);
  const int32_t y = (int32_t)fx_magnitude(v.y);
  const int32_t z = (int32_t)fx_magnitude(v.z);
  return fx_max(fx_max(x, y), z) / 2 + (x + y + z) / 2 + 2;
}

/* Weights of the four particles, Q15: the sum of weight times position is the vector from the nearest
 * point of the first part to that of the second. */
static inline void collision_pair_weights(uint32_t firsts, const ccd_contact *c, int32_t b[4]) {
  FRAY_ASSERT(firsts == 1 || firsts == 2);
  if (firsts == 2) {
    b[0] = c->weight[0] - CCD_ONE;
    b[1] = -c->weight[0];
    b[2] = CCD_ONE - c->weight[1];
    b[3] = c->weight[1];
  } else {
    b[0] = -CCD_ONE;
    b[1] = CCD_ONE - c->weight[0] - c->weight[1];
    b[2] = c->weight[0];
    b[3] = c->weight[1];
  }
}

/* Speed of the second part away from the first, along the normal. */
static inline int64_t collision_pair_speed(const fray_world *w, const uint32_t p[4], const int32_t b[4],
                                           vec3 normal) {
  int64_t sum = 0;
  for (uint32_t n = 0; n < 4; ++n)
    sum = fx_add64(sum, fx_mul_wide(vec_dot_unit(world_velocity(w, p[n]), normal), b[n]));
  return fx_round64(sum, 15);
}

/* The second part lies beyond the first along the normal at the start and at the end of the tick, and
 * so, as all paths are straight, in between. */
static inline int collision_pair_is_beyond(const ccd_path path[4], uint32_t firsts, vec3 normal) {
  const vec3 begin = path[0].begin;
  const vec3 end = path[0].end;
  int64_t first_begin = 0;
  int64_t first_end = 0;
  if (firsts == 2) {
    first_begin = collision_pair_project(begin, path[1].begin, normal);
    first_end = collision_pair_project(end, path[1].end, normal);
  }
  for (uint32_t n = firsts; n < 4; ++n) {
    const int64_t at_begin = collision_pair_project(begin, path[n].begin, normal);
    const int64_t at_end = collision_pair_project(end, path[n].end, normal);
    if (at_begin <= 0 || at_begin <= first_begin || at_end <= 0 || at_end <= first_end) return 0;
  }
  return 1;
}

#endif
