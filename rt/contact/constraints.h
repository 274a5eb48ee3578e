/* SPDX-License-Identifier: Apache-2.0 */
/* Contact constraints of a membrane: found once a substep, solved in each of its elastic steps. */
#ifndef FRAY_CONTACT_CONSTRAINTS_H
#define FRAY_CONTACT_CONSTRAINTS_H

#include "rt/elastic/step_impulse.h"

/* Behind bodies_advance(), before the elastic steps begin. */
void contact_constraints_find(fray_world *w);
/* Between the forces of an elastic step and the motion of its vertices: impulses on both. */
void contact_constraints_solve(fray_world *w, const elastic_step *step);
/* Behind the elastic steps, whose positions it changes: what got into a primitive nevertheless. */
void contact_guard_apply(fray_world *w);

/* The edge of the world: once a substep, and in each step. */
void world_edge_find(fray_world *w);
void world_edge_solve(fray_world *w, const elastic_step *step);

/* Parts of these: free bodies on planes. */
void contact_planes_find(fray_world *w);
void contact_planes_solve(fray_world *w, const elastic_step *step);

/* There is no room for a constraint: a fault, and for the rest of the substep nothing moves positions off
 * bodies. Where a velocity was not stopped, its position is stopped again and again, and stores more each
 * time than it took. */
void contact_constraint_miss(fray_world *w);
/* Adds a constraint; `gap` is in Q24 lu. Misses it where the pool is full. */
void contact_constraint_add(fray_world *w, uint32_t body, constraint_kind kind,
                            const uint32_t vertex[3], const int32_t weight[3], vec3 normal,
                            int64_t gap);
void contact_constraint_add_vertex(fray_world *w, uint32_t body, constraint_kind kind,
                                   uint32_t vertex, vec3 normal, int64_t gap);

/* From a body to a vertex, as both are in this step: Q24 lu, and Q28 below that, not negative. */
typedef struct {
  vec3 whole, rest;
} contact_way_out;
contact_way_out contact_way_out_of(const fray_world *w, uint32_t b, uint32_t p);

/* Of a point of the cloth and the body, Q16 of a particle's mass; 0: nothing of it can move. */
int32_t contact_effective_mass(const fray_world *w, uint32_t body, const uint32_t vertex[3],
                               const int32_t weight[3]);

#endif
