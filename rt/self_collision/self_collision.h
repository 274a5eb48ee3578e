/* SPDX-License-Identifier: Apache-2.0 */
/* Self-collision, once a tick, on the straight paths of the whole tick. */
#ifndef FRAY_SELF_COLLISION_SELF_COLLISION_H
#define FRAY_SELF_COLLISION_SELF_COLLISION_H

#include "rt/state/world.h"

/* Before the first substep: positions at the start of the tick. */
void yarn_collision_begin(fray_world *w);
void triangle_collision_begin(fray_world *w);

/* In the last substep: of yarns after breaks and splits, of triangles after all that moves vertices. */
void yarn_collision_solve(fray_world *w);
void triangle_collision_solve(fray_world *w);
/* Before an attempt, with so many left: all pairs that may meet are joined before the last but one, all of
 * the cloth before the last. */
void triangle_collision_widen(fray_world *w, uint32_t left);

#endif
