/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of triangle self-collision; triangle_collision.c says how they work together. */
#ifndef FRAY_SELF_COLLISION_TRIANGLE_COLLISION_H
#define FRAY_SELF_COLLISION_TRIANGLE_COLLISION_H

#include "rt/self_collision/collision_pair.h"
#include "rt/self_collision/impact_zones.h"

/* Finds all pairs that may come within the thickness of each other while every vertex ends within the
 * slack of its path (tri.active); pairs for which there is no room are merged. Returns 0 iff a vertex
 * travels too far for that. With is_ahead paths are by velocities: no later search uses what this finds. */
int triangle_collision_find(fray_world *w, int is_ahead);

/* Tests two triangles against each other: lists their pairs of features within `reach`, and activates
 * those that may collide in this tick. */
void triangle_collision_test(fray_world *w, uint32_t t, uint32_t other, int32_t reach);
/* Tests a listed pair anew: when the next test is due, and whether it may collide in this tick. */
void triangle_collision_check(fray_world *w, uint32_t n);

/* Distance of the two, a lower bound: at the start of the tick, and along that direction at its end. */
ccd_gap triangle_collision_gap(const fray_world *w, const triangle_pair *pair);

/* As yarn_collision_push() and yarn_collision_touches(). */
int triangle_collision_push(fray_world *w, triangle_pair *pair);
int triangle_collision_touches(fray_world *w, const triangle_pair *pair);

/* Adds a constraint of the elastic steps for two features that come near each other. */
void triangle_collision_constrain(fray_world *w, const triangle_pair *pair);
void self_constraint_add(fray_world *w, const uint32_t p[4], const int32_t weight[4], vec3 normal,
                          int64_t gap);

/* Puts all four vertices into one impact zone. */
void triangle_collision_merge(fray_world *w, const triangle_pair *pair);

#endif
