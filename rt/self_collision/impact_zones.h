/* SPDX-License-Identifier: Apache-2.0 */
/* Rigid impact zones (Bridson et al. 2002), without rotation: particles that collide on their straight
 * paths of a tick are merged into zones, and each zone moves by the mean of its members' paths, from
 * where the tick began. Zones are trees in self_state.zone_of: union by the lower number, so that a
 * zone's root is its first member. */
#ifndef FRAY_SELF_COLLISION_IMPACT_ZONES_H
#define FRAY_SELF_COLLISION_IMPACT_ZONES_H

#include "rt/state/world.h"

/* Puts every particle into a zone of its own and sets the ends of paths to current positions. */
void impact_zones_begin(fray_world *w);
/* The root of a particle's zone. */
uint32_t impact_zones_of(fray_world *w, uint32_t particle);
void impact_zones_join(fray_world *w, uint32_t p, uint32_t q);
/* A tick of a membrane may be done again with the zones that it has found. Before its first attempt
 * there are none. */
void impact_zones_forget(fray_world *w);
/* Adds the bodies that vertices are pinned to to those for the next attempt, or these and the zones of now;
 * joined_new: some are new. */
void impact_zones_keep_pinned(fray_world *w);
void impact_zones_keep(fray_world *w);
/* Puts two into one of these zones; or all that are not attached: FRAY_FAULT_SELF_COLLISION_BUDGET. */
void impact_zones_keep_pair(fray_world *w, uint32_t p, uint32_t q);
void impact_zones_keep_all(fray_world *w);
/* The root of a particle's zone among those of earlier attempts. */
uint32_t impact_zones_joined(fray_world *w, uint32_t particle);
/* Moves every zone by its members' mean path; a zone with an attached or pinned member moves as that one
 * does. Positions only: velocities do not change. Cost: linear in the particles. */
void impact_zones_move(fray_world *w);
/* Keeps a particle within FX_EDGE_MAX. */
void impact_zones_hold(fray_world *w, uint32_t p);
/* Moves a particle in this round, without changing its velocity. */
void impact_zones_shift(fray_world *w, uint32_t p, vec3 by);
/* 1 iff every particle is within the slack of the end of its path, along each axis. */
int impact_zones_are_near(const fray_world *w);
/* Every particle of a zone gets the zone's mean velocity; momentum is conserved to the last bit. */
void impact_zones_average(fray_world *w);
/* One zone of the whole cloth, the last resort; sets FRAY_FAULT_SELF_COLLISION_BUDGET. */
void impact_zones_join_all(fray_world *w);

#endif
