/* SPDX-License-Identifier: Apache-2.0 */
/* Tiles of a sheet and its triangles, where they were listed and where they are: for layers_near.c. */
#ifndef FRAY_STAGE_LAYERS_TILES_H
#define FRAY_STAGE_LAYERS_TILES_H

#include "rt/stage/zones.h"

enum {
  LAYERS_PATH_MOST = 1 << 28, /* Q24 lu */
  LAYERS_TOO_FAR = 1 << 29    /* in a tick, or from where it was: nobody knows whom it meets */
};

/* How far it goes from one place to the other, beside a mean; LAYERS_TOO_FAR above LAYERS_PATH_MOST. */
int32_t tiles_gone_by(vec3 from, vec3 to, vec3 mean);

/* Nothing is listed: all triangles are stale, all tiles far from each other. */
void tiles_begin(fray_world *w);
/* Triangles that a tear or cut has changed are stale. */
void tiles_follow(fray_world *w);
/* Those that are no more where they were listed, or will not be in this tick, are to be listed: fills
 * w->layer_stale, and boxes; then the same of tiles. */
void tiles_find_stale(fray_world *w);
void tiles_find_beside(fray_world *w);

static inline uint32_t triangles_of(const fray_world *w) { return (uint32_t)w->sheet.state->triangles; }

static inline uint32_t tiles_of(const fray_world *w) { return w->listed->across * w->listed->across; }

/* Two that are farther apart do not meet, if they do not go anywhere. */
static inline int64_t least_apart(const fray_world *w) {
  return (int64_t)w->selves->thickness + 4 * (int64_t)w->selves->slack;
}

static inline layer_beside *between(const fray_world *w, uint32_t a, uint32_t b) {
  return a > b ? &w->tiles_beside[a * (a - 1u) / 2u + b] : &w->tiles_beside[b * (b - 1u) / 2u + a];
}

/* Without a branch: which of the six it is nobody can foresee. */
static inline int overlap(const int32_t *low, const int32_t *high, const int32_t *other_low, const int32_t *other_high) {
  uint32_t apart = 0;
  for (uint32_t k = 0; k < 3; ++k) apart |= (low[k] > other_high[k] ? 1u : 0u) | (other_low[k] > high[k] ? 1u : 0u);
  return apart == 0;
}

static inline void widen_by(int32_t *low, int32_t *high, int64_t by) {
  for (uint32_t k = 0; k < 3; ++k) {
    low[k] = fx_saturate(low[k] - by);
    high[k] = fx_saturate(high[k] + by);
  }
}
/* What a triangle may still go from where it is. */
static inline int64_t room_of(const fray_world *w, uint32_t t) { return (int64_t)w->layer_ways[t].room + w->layer_ways[t].gone; }

/* What two tiles may still go beside each other from where they are. */
static inline int64_t room_between(const fray_world *w, uint32_t a, uint32_t b) {
  return a == b ? 0 : (int64_t)between(w, a, b)->room + between(w, a, b)->gone;
}

#endif
