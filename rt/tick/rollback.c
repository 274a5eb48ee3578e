/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/tick/rollback.h"

#include "rt/base/bytes.h"
#include "rt/membrane/membrane.h"

enum { FAULTS_KEPT = FRAY_FAULT_SELF_COLLISION_BUDGET };

static void save_vertex(fray_world *w, uint32_t p) {
  attempt_vertex *v = &w->attempt.vertices[p];
  v->position = world_position(w, p);
  v->velocity = world_velocity(w, p);
  v->remainder[0] = w->p.rx[p];
  v->remainder[1] = w->p.ry[p];
  v->remainder[2] = w->p.rz[p];
}

static void restore_vertex(fray_world *w, uint32_t p) {
  attempt_vertex *v = &w->attempt.vertices[p];
  v->pinned = 0;
  w->p.x[p] = v->position.x;
  w->p.y[p] = v->position.y;
  w->p.z[p] = v->position.z;
  world_set_velocity(w, p, v->velocity);
  w->p.rx[p] = v->remainder[0];
  w->p.ry[p] = v->remainder[1];
  w->p.rz[p] = v->remainder[2];
}

void rollback_save(fray_world *w) {
  const tick_attempt *a = &w->attempt;
  FRAY_ASSERT(world_repeats_ticks(w));
  for (uint32_t p = 0; p < w->p.count; ++p) save_vertex(w, p);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    a->bodies[b].state = w->rigid.states[b];
    a->bodies[b].motion = w->rigid.motion[b];
  }
  bytes_copy(a->bend_states, w->membrane.bend_states, triangles_in_use(w) * sizeof *a->bend_states);
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) a->owed[t] = w->membrane.stiffness[t].owed;
  bytes_copy(a->begin->gravity_phase, w->state->gravity_phase, sizeof a->begin->gravity_phase);
  bytes_copy(a->begin->momentum_remainder, w->trimesh.state->momentum_remainder,
             sizeof a->begin->momentum_remainder);
  bytes_copy(a->begin->contact_tank, w->trimesh.state->contact_tank, sizeof a->begin->contact_tank);
  a->begin->faults = w->state->faults;
#if FRAY_ENERGY
  a->begin->energy = w->energy;
#endif
}

void rollback_restore(fray_world *w) {
  const tick_attempt *a = &w->attempt;
  FRAY_ASSERT(world_repeats_ticks(w));
  for (uint32_t p = 0; p < w->p.count; ++p) restore_vertex(w, p);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    w->rigid.states[b] = a->bodies[b].state;
    w->rigid.motion[b] = a->bodies[b].motion;
  }
  a->begin->joined_any |= a->begin->joined_new;
  bytes_copy(w->membrane.bend_states, a->bend_states, triangles_in_use(w) * sizeof *a->bend_states);
  bend_offsets_load(w);
  bend_follow_again(w);
  bend_fade_begin(w);
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) w->membrane.stiffness[t].owed = a->owed[t];
  bytes_copy(w->state->gravity_phase, a->begin->gravity_phase, sizeof a->begin->gravity_phase);
  bytes_copy(w->trimesh.state->momentum_remainder, a->begin->momentum_remainder,
             sizeof a->begin->momentum_remainder);
  bytes_copy(w->trimesh.state->contact_tank, a->begin->contact_tank, sizeof a->begin->contact_tank);
  w->state->faults = a->begin->faults | (w->state->faults & FAULTS_KEPT);
#if FRAY_ENERGY
  w->energy = a->begin->energy;
#endif
}
