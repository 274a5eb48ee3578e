/* SPDX-License-Identifier: Apache-2.0 */
/* Impact zones that an earlier attempt at the tick has found, in the elastic steps of the next. */
#ifndef FRAY_SELF_COLLISION_IMPACT_ZONE_STEPS_H
#define FRAY_SELF_COLLISION_IMPACT_ZONE_STEPS_H

#include "rt/elastic/step_impulse.h"

/* Behind all other impulses of an elastic step: those that make each zone move as one. */
void impact_zone_steps_solve(fray_world *w, const elastic_step *step);

#endif
