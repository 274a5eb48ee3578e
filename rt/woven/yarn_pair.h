/* SPDX-License-Identifier: Apache-2.0 */
/* A point on a link of one yarn and a point on a link of another, and moving them apart. */
#ifndef FRAY_WOVEN_YARN_PAIR_H
#define FRAY_WOVEN_YARN_PAIR_H

#include "rt/state/world.h"

enum { YARN_PAIR_ONE = 1 << 15 };

/* Two points by their barycentric weights: ends 0 and 1 are those of the first link, 2 and 3 of the second.
 * Weights are Q15, 0..YARN_PAIR_ONE, and add up to YARN_PAIR_ONE on each link. */
typedef struct {
  uint32_t particle[4];
  int32_t weight[4];
} yarn_pair;

/* From the second link's point to the first one's, Q24 lu. Cost: constant. */
vec3 yarn_pair_gap(const fray_world *w, const yarn_pair *pair);
/* Makes yarn_pair_gap() longer by `by`, to +-1 in each component; |by| at most 1/8 lu on each axis. The
 * mass of each end weighs. Momentum, with that of bodies that carry an end, stays the same to the last bit;
 * iff `keep_velocity`, no velocity changes. Returns 0, having done nothing, iff no end is free to move.
 * Cost: constant. */
int yarn_pair_move(fray_world *w, const yarn_pair *pair, vec3 by, int keep_velocity);

#endif
