/* SPDX-License-Identifier: Apache-2.0 */
/* Patches of the membrane: triangles near each other at rest; and how far triangles and patches have
 * travelled since their pairs were listed (triangle_collision_find.c says what for). */
#ifndef FRAY_SELF_COLLISION_PATCHES_H
#define FRAY_SELF_COLLISION_PATCHES_H

#include "rt/self_collision/collision_pair.h"

enum {
  PATCHES_TRAVEL_MAX = 1 << 28, /* Q24 lu */
  PATCHES_TOO_FAR = 1 << 29     /* farther in a tick, or since it was listed, than the list can represent */
};

/* Length of the way from one position to the other, less a mean; PATCHES_TOO_FAR above PATCHES_TRAVEL_MAX. */
int32_t patches_travel(vec3 from, vec3 to, vec3 mean);

/* Adds the last tick's mean path of each patch to its travel. */
void patches_advance(fray_world *w);
/* Empties the list: all triangles are stale, no two patches are neighbours. */
void patches_begin(fray_world *w);
/* Triangles that a tear or blade cut has changed become stale. */
void patches_follow(fray_world *w);
/* Finds stale triangles (tri.stale): those that exceed their budget of travel before the tick ends;
 * sets all boxes. */
void patches_find_stale(fray_world *w);
/* The same of pairs of patches; those near enough become neighbours. */
void patches_find_neighbours(fray_world *w);

static inline uint32_t patches_count(const fray_world *w) {
  return w->tri.list->across * w->tri.list->across;
}

/* Two features that are farther apart than this do not collide if neither moves. */
static inline int64_t patches_distance_min(const fray_world *w) {
  return (int64_t)w->self.constants->thickness + 4 * (int64_t)w->self.constants->slack;
}

static inline patch_pair *patches_pair(const fray_world *w, uint32_t a, uint32_t b) {
  FRAY_ASSERT(a != b && a < patches_count(w) && b < patches_count(w));
  return a > b ? &w->tri.patch_pairs[a * (a - 1u) / 2u + b] : &w->tri.patch_pairs[b * (b - 1u) / 2u + a];
}

/* Without branches, which could not be predicted: any of the six may be the one that separates. */
static inline int patches_overlap(vec3 low, vec3 high, vec3 other_low, vec3 other_high) {
  return ((low.x <= other_high.x) & (other_low.x <= high.x) & (low.y <= other_high.y) &
          (other_low.y <= high.y) & (low.z <= other_high.z) & (other_low.z <= high.z)) != 0;
}

static inline void patches_widen(vec3 *low, vec3 *high, int64_t by) {
  *low = vec_make(fx_saturate(low->x - by), fx_saturate(low->y - by), fx_saturate(low->z - by));
  *high = vec_make(fx_saturate(high->x + by), fx_saturate(high->y + by), fx_saturate(high->z + by));
}

static inline int64_t patches_allowance(const fray_world *w, uint32_t a, uint32_t b) {
  return a == b ? 0 : patches_pair(w, a, b)->allowance;
}

#endif
