/* SPDX-License-Identifier: Apache-2.0 */
/* A point on a warp spring and one on a weft spring of a split crossing, and moving them apart. */
#ifndef FRAY_WOVEN_YARN_SLIP_H
#define FRAY_WOVEN_YARN_SLIP_H

#include "rt/state/world.h"

enum { YARN_SLIP_ONE = 1 << 15 };

/* Two points by their barycentric weights: ends 0 and 1 are those of the warp spring, 2 and 3 of the weft
 * spring. Weights are Q15, 0..YARN_SLIP_ONE, and add up to YARN_SLIP_ONE on each spring. */
typedef struct {
  uint32_t particle[4];
  int32_t weight[4];
} yarn_slip_pair;

/* Finds the closest points of the springs at a split crossing (section 3.3). Returns 0, without a pair, iff
 * one of its yarns has no spring left here. Cost: constant. */
int yarn_slip_closest(const fray_world *w, uint32_t crossing, yarn_slip_pair *pair);
/* From the weft's point to the warp's, Q24 lu. Cost: constant. */
vec3 yarn_slip_gap(const fray_world *w, const yarn_slip_pair *pair);
/* Makes yarn_slip_gap() longer by `by`, to +-1 in each component; |by| at most 1/8 lu on each axis. Momentum,
 * with that of bodies that carry an end, stays the same to the last bit; iff `keep_velocity`, no velocity
 * changes. Returns 0, having done nothing, iff no end of the springs is free to move. Cost: constant. */
int yarn_slip_move(fray_world *w, const yarn_slip_pair *pair, vec3 by, int keep_velocity);

/* Keeps the yarns of a loose crossing a thickness apart (equation 1), with friction. Cost: constant. */
void yarn_slip_crossing(fray_world *w, uint32_t crossing);
#if SLIP_LISTED
/* Once a tick: moves the crossings that a SIMD kernel can process from the lists slip_head to slip_list, by
 * colour. Cost: linear in the slipping crossings. */
void yarn_slip_list_fill(fray_world *w);
/* Slips the listed crossings of a colour, 0..SLIP_COLOURS-1. Cost: linear in them. */
void yarn_slip_list_solve(fray_world *w, uint32_t colour);
#endif

#endif
