/* SPDX-License-Identifier: Apache-2.0 */
/* A tick of woven cloth: the loop of Metaaphanon 2009, section 4 (its step numbers at the right), with
 * substeps around gravity, 4 to 6 and 8. Bend, shear and damping act once a tick, before them;
 * beside elastic yarns bend, shear and the broad phase in each substep. */
#include "rt/contact/contact.h"
#include "rt/energy/energy.h"
#include "rt/integrate/integrate.h"
#include "rt/self_collision/self_collision.h"
#include "rt/tick/tick.h"
#include "rt/woven/woven.h"

/* Yarns split, springs tear. */
static void tear(fray_world *w) {
  if (world_has_yarns(w)) {
    crossing_transition_find(w); /* 7 */
    crossing_split_apply(w);     /* 7 */
  }
  spring_tear_find(w);           /* 7 */
  if (world_has_yarns(w)) yarn_slip_before_breaks(w);
  spring_break_apply(w);         /* 7 */
  if (world_has_yarns(w)) yarn_slip_after_breaks(w);
  energy_stage(w, FRAY_ENERGY_TEARS);
}

void tick_woven(fray_world *w) {
  const uint32_t substeps = (uint32_t)w->params->substeps;
  FRAY_ASSERT(!world_has_membrane(w));
  if (world_is_projected(w)) {
    overstretched_links_apply(w);
    energy_stage(w, FRAY_ENERGY_LIMITS);
  }
  damp_apply(w);       /* 3 */
  energy_stage(w, FRAY_ENERGY_DRAG);
  if (world_is_projected(w)) {
    bend_shear_apply(w); /* 1, 2: structural springs are projected instead */
    energy_springs(w);
  }
  if (world_has_yarns(w)) yarn_grip_update(w);
  energy_stage(w, FRAY_ENERGY_TEARS); /* offsets of contacts that tears began fade */
  if (world_is_projected(w)) contact_gather(w);
  if (world_has_yarn_collision(w)) yarn_collision_begin(w);
  for (uint32_t substep = 0; substep < substeps; ++substep) {
    if (world_has_rigid_meshes(w)) contact_vertices_begin(w);
    bodies_advance(w, substep);
    energy_bodies(w);
    if (world_has_elastic_yarns(w)) {
      bend_shear_apply(w);
      energy_springs(w);
      contact_gather(w);
      yarn_stretch_run(w);
    } else {
      particles_advance(w);      /* 1, 2, 4 */
    }
    particles_carry(w);
    energy_moves(w);
    strain_limit_apply(w);       /* 5 */
    energy_stage(w, FRAY_ENERGY_LIMITS);
    if (world_has_yarns(w) && world_is_projected(w)) yarn_slip_apply(w); /* 5 */
    energy_stage(w, FRAY_ENERGY_SLIP);
    contact_primitives_solve(w); /* 6 */
    if (world_has_rigid_meshes(w)) contact_vertices_solve(w); /* 6 */
    energy_stage(w, FRAY_ENERGY_CONTACT);
    if (substep + 1u == substeps) {
      particles_hold(w);
      energy_stage(w, FRAY_ENERGY_LIMITS);
      tear(w);
    }
    particles_update_velocity(w); /* 8 */
    energy_velocities(w);
    contact_update_velocity(w);   /* 8 */
    if (substep + 1u == substeps && world_has_yarn_collision(w)) {
      energy_stage(w, FRAY_ENERGY_CONTACT);
      yarn_collision_solve(w); /* 6 */
      energy_stage(w, FRAY_ENERGY_SELF_COLLISION);
    }
    bodies_update_velocity(w);
    energy_stage(w, FRAY_ENERGY_CONTACT);
  }
}
