/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of yarn self-collision; yarn_collision.c says how they work together. */
#ifndef FRAY_SELF_COLLISION_YARN_COLLISION_H
#define FRAY_SELF_COLLISION_YARN_COLLISION_H

#include "rt/self_collision/collision_pair.h"
#include "rt/self_collision/impact_zones.h"

/* A segment: its spring and particles, and the crossings that these belong to. */
typedef struct {
  uint32_t spring, p[2], crossing[2];
} yarn_segment;

/* Finds all segments that may come within the thickness of each other while every particle ends within
 * the slack of its path (yarn.pairs). Pairs for which there is no room are pushed at once. What the bounds of
 * the search leave out differs from tick to tick; FRAY_FAULT_SELF_COLLISION_BUDGET says so. */
void yarn_collision_find(fray_world *w);

/* From the sum of a0 and a1 to that of b0 and b1, over 16: components in 29 bits. */
static inline vec3 yarn_collision_between(vec3 a0, vec3 a1, vec3 b0, vec3 b1) {
  return vec_sub(vec_add(vec_asr(b0, 4), vec_asr(b1, 4)), vec_add(vec_asr(a0, 4), vec_asr(a1, 4)));
}
/* Both ends of the second segment are beyond both of the first along d, by more than `reach` over the
 * length of d. */
static inline int yarn_collision_beyond(vec3 a0, vec3 a1, vec3 b0, vec3 b1, vec3 d, int64_t reach) {
  const int64_t a = collision_pair_project(a0, a1, d);
  const int64_t first = reach + (a > 0 ? a : 0);
  return collision_pair_project(a0, b0, d) > first && collision_pair_project(a0, b1, d) > first;
}
/* 1 if the second segment stays beyond the first by more than `by` (at most 2 lu), along the direction
 * between their centres at the start of the tick. Conservative: it may return 0 for such segments too. */
static inline int yarn_collision_paths_apart(const self_path *a0, const self_path *a1, const self_path *b0,
                                             const self_path *b1, int32_t by) {
  const vec3 d = yarn_collision_between(a0->begin, a1->begin, b0->begin, b1->begin);
  const int64_t reach = fx_mul_wide(collision_pair_length(d), by);
  return yarn_collision_beyond(a0->begin, a1->begin, b0->begin, b1->begin, d, reach) &&
         yarn_collision_beyond(a0->end, a1->end, b0->end, b1->end, d, reach);
}

/* Pushes two segments apart where they come nearer than the thickness on their paths, and removes the
 * speed at which they approach. Momentum is conserved to the last bit. Returns 1 iff something was
 * moved. */
int yarn_collision_push(fray_world *w, self_pair *pair);
/* 1 where they touch on their paths, or may. */
int yarn_collision_touches(fray_world *w, const self_pair *pair);

/* Puts all four particles into one impact zone. */
void yarn_collision_merge(fray_world *w, const self_pair *pair);

#endif
