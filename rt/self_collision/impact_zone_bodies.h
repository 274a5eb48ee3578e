/* SPDX-License-Identifier: Apache-2.0 */
/* Impact zones of yarns at spheres, capsules, boxes and planes. Cost: linear in particles and contacts. */
#ifndef FRAY_SELF_COLLISION_IMPACT_ZONE_BODIES_H
#define FRAY_SELF_COLLISION_IMPACT_ZONE_BODIES_H

#include "rt/state/world.h"

/* Leads each zone out of bodies as one, until none of its particles is deeper than at the end of its path.
 * Positions only. A zone with an attached particle stays with that; where a body holds it in another one,
 * FRAY_FAULT_CONTACT_UNRESOLVED says so. Returns 1 iff it moved some. */
int impact_zones_lead_out(fray_world *w);
/* Behind impact_zones_average(): a zone of two and more that touches a body has no speed into it, with
 * friction within the Coulomb cone. Bodies get the opposite impulses. */
void impact_zones_stop(fray_world *w);

#endif
