/* SPDX-License-Identifier: Apache-2.0 */
/* Collision of cloth with rigid bodies: the stages of a tick, in their order. */
#ifndef FRAY_CONTACT_CONTACT_H
#define FRAY_CONTACT_CONTACT_H

#include "rt/state/world.h"

/* Once a tick, in each substep of elastic yarns: broad phase against spheres, capsules, boxes and planes. */
void contact_gather(fray_world *w);

/* Each substep. */
void contact_vertices_begin(fray_world *w);   /* with rigid meshes: positions at the start of the substep */
void contact_primitives_solve(fray_world *w); /* narrow phase, push-out and friction */
void contact_vertices_solve(fray_world *w);   /* with rigid meshes: CCD; of triangles too in some worlds */
void contact_update_velocity(fray_world *w);  /* a touching particle keeps no velocity away from the body */

/* Of elastic yarns, in place of contact_primitives_solve(): planes of meshes that particles may meet, once a
 * substep, begun before the first pull and found behind it; then within an elastic step, behind its forces
 * and before its motion. Cost: linear in the contacts. */
void contact_yarn_planes_begin(fray_world *w);
void contact_yarn_planes_find(fray_world *w);
typedef struct {
  int32_t number; /* of 2^bits in a substep */
  unsigned bits;
  int32_t rise; /* step_rise_of() */
  vec3 gravity; /* the step's part, Q28 lu per substep */
} yarn_step;
void contact_steps_mark(fray_world *w);   /* before all impulses of the step */
void contact_steps_pulled(fray_world *w); /* and behind those of yarns */
void contact_steps_solve(fray_world *w, const yarn_step *step);

/* A free body beside projected yarns is put out of planes, and stops there. */
void contact_planes_push(fray_world *w, uint32_t b);
/* How far body b at `at` is above plane g at `plane`, Q24 lu. */
int64_t contact_height_above(const fray_world *w, uint32_t b, vec3 at, uint32_t g, vec3 plane);

/* Repeats the mesh test after triangle self-collision; returns how many vertices had to be pinned. */
uint32_t contact_vertices_check(fray_world *w);

/* Contacts first to end - 1, for ticks that several workers compute. */
void contact_primitives_range(fray_world *w, uint32_t first, uint32_t end);
void contact_update_velocity_range(fray_world *w, uint32_t first, uint32_t end);

#endif
