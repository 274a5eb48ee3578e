/* SPDX-License-Identifier: Apache-2.0 */
/* Impact zones that an earlier attempt at the tick has found, in the elastic steps of the next. */
#ifndef FRAY_SELF_COLLISION_IMPACT_ZONE_STEPS_H
#define FRAY_SELF_COLLISION_IMPACT_ZONE_STEPS_H

#include "rt/elastic/step_impulse.h"

/* Before an attempt: the zones that move as one in it (elastic/step_zone.h). */
void impact_zone_steps_begin(fray_world *w);
/* Behind edge_limits_find(): leaves out edges within a zone. */
void impact_zone_steps_leave_edges(fray_world *w);
/* Behind the forces of an elastic step: what is in a zone gets the zone's velocity. */
void impact_zone_steps_hold(fray_world *w, const elastic_step *step);
/* Behind others' impulses: it gets what these have made of that. */
void impact_zone_steps_share(fray_world *w, const elastic_step *step);
/* Behind the last elastic step of the tick: velocities of its end, half a step later, for what acts there. */
void impact_zone_steps_ahead(fray_world *w);
/* And back. What has moved as one then has no kinetic energy within it. */
void impact_zone_steps_back(fray_world *w);

#endif
