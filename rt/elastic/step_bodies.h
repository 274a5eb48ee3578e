/* SPDX-License-Identifier: Apache-2.0 */
/* Bodies in the elastic steps of a membrane: free ones move in each step with what they hold and
 * touch, driven ones are carried along their way through the substep. */
#ifndef FRAY_ELASTIC_STEP_BODIES_H
#define FRAY_ELASTIC_STEP_BODIES_H

#include "rt/elastic/step_impulse.h"

void step_bodies_begin(fray_world *w);
/* Behind the forces of a step: attached vertices pull at their bodies, free bodies fall. */
void step_bodies_pull(fray_world *w, const elastic_step *step);
/* Behind the contacts of step n: bodies move, and attached vertices with them. */
void step_bodies_move(fray_world *w, const elastic_step *step, int32_t n);
/* Free bodies have moved, to Q24 and the bits below it. */
void step_bodies_end(fray_world *w);

#endif
