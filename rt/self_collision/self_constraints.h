/* SPDX-License-Identifier: Apache-2.0 */
/* Triangles of a membrane that may meet in a tick, as constraints of its elastic steps. */
#ifndef FRAY_SELF_COLLISION_SELF_CONSTRAINTS_H
#define FRAY_SELF_COLLISION_SELF_CONSTRAINTS_H

#include "rt/elastic/step_impulse.h"

/* Behind triangle_collision_begin(): by the velocities with which the tick begins. */
void self_constraints_find(fray_world *w);
/* Before the first substep of each attempt at the tick. */
void self_constraints_begin(fray_world *w);
/* In each elastic step, behind its forces. */
void self_constraints_solve(fray_world *w, const elastic_step *step);

#endif
