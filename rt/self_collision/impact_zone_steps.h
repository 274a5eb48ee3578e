/* SPDX-License-Identifier: Apache-2.0 */
/* Impact zones that an earlier attempt at the tick has found, in the elastic steps of the next. */
#ifndef FRAY_SELF_COLLISION_IMPACT_ZONE_STEPS_H
#define FRAY_SELF_COLLISION_IMPACT_ZONE_STEPS_H

#include "rt/elastic/step_impulse.h"

/* Behind edge_limits_find(): leaves out edges within a zone, since the zone would undo what these get. */
void impact_zone_steps_begin(fray_world *w);
/* Behind all other impulses of an elastic step: those that make each zone move as one. */
void impact_zone_steps_solve(fray_world *w, const elastic_step *step);
/* Behind the last elastic step of the tick: vertices leave their zones without kinetic energy within them. */
void impact_zone_steps_end(fray_world *w);

#endif
