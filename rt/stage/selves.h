/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the stage that keeps yarns from passing through each other; stage/selves.c says how. */
#ifndef FRAY_STAGE_SELVES_H
#define FRAY_STAGE_SELVES_H

#include "rt/base/sweep.h"
#include "rt/model/world.h"
#include "rt/stage/slip.h"
#include "rt/stage/zones.h"

/* A living structural link: its row and particles, and the crossings that they stand for. */
typedef struct {
  uint32_t row, p[2], crossing[2];
} self_segment;

/* Fills w->pairs with all segments that may come within the thickness of each other while every particle
 * ends within the slack of ways.end. What has no room is joined. Returns 0 iff the bound of visits was
 * reached: then pairs may be missing. */
int selves_find(fray_world *w);

/* Both segments of a pair, in the tick: particles, where they began and are now. */
typedef struct {
  uint32_t p[2][2];
  sweep_point way[2][2];
} self_meeting;
self_meeting selves_meeting(const fray_world *w, uint32_t row_a, uint32_t row_b);

/* The way between the middles of two segments, twice, in 29 bits. */
static inline vec3 selves_between(vec3 a0, vec3 a1, vec3 b0, vec3 b1) {
  return vec_make(fx_asr(b0.x, 4) + fx_asr(b1.x, 4) - fx_asr(a0.x, 4) - fx_asr(a1.x, 4),
                  fx_asr(b0.y, 4) + fx_asr(b1.y, 4) - fx_asr(a0.y, 4) - fx_asr(a1.y, 4),
                  fx_asr(b0.z, 4) + fx_asr(b1.z, 4) - fx_asr(a0.z, 4) - fx_asr(a1.z, 4));
}
/* The second's ends are so far beyond both of the first's. */
static inline int selves_beyond(vec3 a0, vec3 a1, vec3 b0, vec3 b1, vec3 d, int64_t reach) {
  const int64_t a = zones_dot(vec_sub(a1, a0), d);
  const int64_t most = reach + (a > 0 ? a : 0);
  return zones_dot(vec_sub(b0, a0), d) > most && zones_dot(vec_sub(b1, a0), d) > most;
}
/* 1 where the second segment stays farther than `by` (at most 2 lu) beyond the first, along the way between
 * their middles when the tick began; it may say 0 too. */
static inline int selves_ways_apart(const self_way *a0, const self_way *a1, const self_way *b0,
                                    const self_way *b1, int32_t by) {
  const vec3 d = selves_between(a0->begin, a1->begin, b0->begin, b1->begin);
  const int64_t reach = fx_mul_wide(zones_length(d), by);
  return selves_beyond(a0->begin, a1->begin, b0->begin, b1->begin, d, reach) &&
         selves_beyond(a0->end, a1->end, b0->end, b1->end, d, reach);
}
int selves_stay_apart(const self_meeting *m, int32_t by);

/* Pushes the two apart where they come too near on their ways, and takes away the speed at which they
 * approach. Momentum is the same afterwards to the last bit. Returns 1 iff something was pushed. */
int selves_push(fray_world *w, self_pair *pair);
/* 1 where they touch on their ways, or cannot be told not to. */
int selves_touch(fray_world *w, self_pair *pair);

/* What is joined moves as one. */
void selves_join(fray_world *w, const self_pair *pair);

#endif
