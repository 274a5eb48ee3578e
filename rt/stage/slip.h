/* SPDX-License-Identifier: Apache-2.0 */
/* A point on a warp spring and one on a weft spring, and moving them apart. */
#ifndef FRAY_STAGE_SLIP_H
#define FRAY_STAGE_SLIP_H

#include "rt/model/world.h"

enum { SLIP_ONE = 1 << 15 };

/* Ends 0 and 1 are those of the warp spring, 2 and 3 of the weft spring; b: Q15, how near each point
 * is to each end, SLIP_ONE in all for each spring. */
typedef struct {
  uint32_t p[4];
  int32_t b[4];
} slip_pair;

/* The closest points of a couple's springs; 0 where one of its yarns has no spring left here. */
int slip_closest(const fray_world *w, uint32_t crossing, slip_pair *pair);
/* From the weft's point to the warp's, Q24 lu. */
vec3 slip_gap(const fray_world *w, const slip_pair *pair);
/* Makes slip_gap() longer by `by`, to +-1 in each component; |by| at most 1/8 lu on each axis. Momentum
 * is the same afterwards to the last bit, what a body that holds an end gave included; iff `quiet`,
 * no velocity changes. Returns 0, having done nothing, iff nothing of the springs is free to move. */
int slip_move(fray_world *w, const slip_pair *pair, vec3 by, int quiet);

/* What a loose couple does in a substep. */
void slip_couple(fray_world *w, uint32_t crossing);
#if SLIP_PLANNED
/* Takes from the lists of this tick's couples what a kernel takes. */
void slip_plan(fray_world *w);
/* The planned couples of a colour. */
void slip_run_planned(fray_world *w, uint32_t colour);
#endif

#endif
