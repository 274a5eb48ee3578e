/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of contacts see of each substep, see watched_tick.h: ways begin where the last ones ended; substeps
 * that do not resolve are counted and not looked at. The test defines look_at_substep(). */
#ifndef FRAY_TESTS_PHYSICS_CONTACT_WATCH_H
#define FRAY_TESTS_PHYSICS_CONTACT_WATCH_H

#include "rt/base/vec.h"
#include "tests/lib/watched_tick.h"
#include "tests/lib/world_fixture.h"
#include "tests/physics/exact_ccd.h"

enum { PARTICLES_MOST = 4096 };

static void look_at_substep(const fray_world *w);

static vec3 ended[PARTICLES_MOST];
static uint32_t ended_count;
static uint32_t in_substep; /* 1: bodies have moved, the next contacts are those that count */
static uint32_t every = 1;  /* ticks whose ways are looked at */
static uint32_t passed, broken, paths, near_paths, jams; /* jams: substeps that say JAMMED */
static fray_work watched_work;                           /* sums */

static void watch_begin(fray_world *w) {
  in_substep = state_tick(w->state) % every == 0;
  jams += (w->state->faults & (int32_t)FRAY_FAULT_CONTACT_UNRESOLVED) != 0;
  w->state->faults &= ~(int32_t)FRAY_FAULT_CONTACT_UNRESOLVED;
  for (uint32_t p = (uint32_t)w->params->attached; p < ended_count; ++p)
    broken += ended[p].x != w->contact.start_x[p] || ended[p].y != w->contact.start_y[p] || ended[p].z != w->contact.start_z[p];
}

static void watch_end(const fray_world *w) {
  if (!in_substep) return;
  in_substep = 0;
  ended_count = 0;
  if ((w->state->faults & (int32_t)FRAY_FAULT_CONTACT_UNRESOLVED) != 0) return;
  look_at_substep(w);
  ended_count = w->p.count;
  for (uint32_t p = 0; p < w->p.count; ++p) ended[p] = world_position(w, p);
}

static void watch_again(void) { ended_count = 0; }

static inline void watch_reset(void) {
  passed = broken = paths = near_paths = ended_count = jams = 0;
  memset(&watched_work, 0, sizeof watched_work);
}

/* One tick; its work keeps to the world's bound. Returns faults. */
static inline uint32_t watch_tick(fixture *f, const fray_input *input) {
  fray_output out;
  const fray_work limits = fray_work_bound(f->w);
  watched_tick(f->w, input, &out);
  watched_work.mesh_ccd += out.work.mesh_ccd;
  watched_work.mesh_pins += out.work.mesh_pins;
  CHECK(out.work.mesh_tests <= limits.mesh_tests && out.work.mesh_boxes <= limits.mesh_boxes &&
        out.work.mesh_ccd <= limits.mesh_ccd && out.work.mesh_pins <= limits.mesh_pins);
  return out.faults;
}

static inline moving_point moving_between(vec3 begin, vec3 end) {
  const moving_point made = {{begin.x, begin.y, begin.z}, {end.x, end.y, end.z}};
  return made;
}

#endif
