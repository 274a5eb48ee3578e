/* SPDX-License-Identifier: Apache-2.0 */
/* A tick of the membrane (Karaoz 2015): stress, tears and cuts once a tick (sections 2.7, 3.1, 3.2); each
 * substep is some elastic steps of stress and bending (2.4, 2.5) with contact constraints, then the tests of
 * paths (2.6). */
#include "rt/contact/contact.h"
#include "rt/elastic/step_handles.h"
#include "rt/energy/energy.h"
#include "rt/integrate/integrate.h"
#include "rt/membrane/membrane.h"
#include "rt/self_collision/impact_zone_steps.h"
#include "rt/self_collision/impact_zones.h"
#include "rt/self_collision/self_collision.h"
#include "rt/self_collision/self_constraints.h"
#include "rt/tick/rollback.h"
#include "rt/tick/tick.h"

/* What this attempt has found, for the next. */
static void end_zones(fray_world *w) {
  impact_zone_steps_ahead(w);
  if (world_has_triangle_collision(w))
    triangle_collision_solve(w);
  else
    impact_zones_keep_pinned(w);
  impact_zone_steps_back(w);
}

static void run_substeps(fray_world *w) {
  const uint32_t substeps = (uint32_t)w->params->substeps;
  if (world_has_handles(w)) step_handles_begin(w);
  for (uint32_t substep = 0; substep < substeps; ++substep) {
    if (world_has_rigid_meshes(w)) contact_vertices_begin(w);
    bodies_advance(w, substep);
    energy_bodies(w);
    elastic_steps_run(w, substep);
    particles_carry(w);
    energy_moves(w);
    if (world_has_rigid_meshes(w)) contact_vertices_solve(w);
    energy_stage(w, FRAY_ENERGY_CONTACT);
    if (substep + 1u == substeps) {
      particles_hold(w);
      energy_stage(w, FRAY_ENERGY_LIMITS);
      if (world_repeats_ticks(w)) end_zones(w);
      energy_stage(w, world_zone_stage(w));
    }
    particles_update_velocity(w);
    energy_velocities(w);
    bodies_update_velocity(w);
    energy_stage(w, FRAY_ENERGY_CONTACT);
  }
}

/* What self-collision had to put together, or a body to stop, moves as one from the beginning in the next
 * attempt. */
static void run_attempts(fray_world *w) {
  const int collides = world_has_triangle_collision(w);
  if (collides) triangle_collision_begin(w);
  impact_zones_forget(w);
  rollback_save(w);
  if (collides) self_constraints_find(w);
  for (uint32_t left = TICK_ATTEMPTS; left != 0; --left) {
    w->attempt.begin->joined_new = 0;
    impact_zone_steps_begin(w);
    if (collides) self_constraints_begin(w);
    run_substeps(w);
    if (left == 1 || w->attempt.begin->joined_new == 0) return;
    if (collides) triangle_collision_widen(w, left - 1u);
    rollback_restore(w);
  }
}

void tick_membrane(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w));
  if (!world_has_cracks(w)) membrane_stress_update(w);
  if (w->params->tearing != 0) {
    if (world_has_cracks(w)) crack_advance(w);
    else membrane_tear_apply(w);
  }
  if (world_has_blades(w)) blade_cut_apply(w);
  membrane_gains_update(w);
  energy_stage(w, w->work.tears != 0 ? FRAY_ENERGY_TEARS : FRAY_ENERGY_MATERIAL);
  wind_apply(w);
  energy_wind(w);
  contact_gather(w);
  if (world_repeats_ticks(w))
    run_attempts(w);
  else
    run_substeps(w);
}
