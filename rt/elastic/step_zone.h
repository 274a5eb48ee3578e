/* SPDX-License-Identifier: Apache-2.0 */
/* What moves a vertex in an elastic step: itself, the body that holds it, or an impact zone that an earlier
 * attempt at the tick has found (self_collision/impact_zone_steps.c). A zone moves as one vertex would. */
#ifndef FRAY_ELASTIC_STEP_ZONE_H
#define FRAY_ELASTIC_STEP_ZONE_H

#include "rt/state/world.h"

enum { STEP_NO_BODY = 0xFFFF };

/* Its zone, or NULL. */
static inline self_zone *step_zone_of(const fray_world *w, uint32_t p) {
  FRAY_ASSERT(p < w->p.count);
  if (!world_repeats_ticks(w) || w->attempt.begin->joined_any == 0) return NULL;
  self_zone *z = &w->self.zones[w->attempt.vertices[p].joined];
  return z->members > 1 || z->held != STEP_NO_BODY ? z : NULL;
}

/* The body that holds it or its zone, or STEP_NO_BODY. */
static inline uint32_t step_body_of(const fray_world *w, uint32_t p) {
  if (particle_is_attached(w, p)) return w->p.attach_body[p];
  const self_zone *z = step_zone_of(w, p);
  return z == NULL ? STEP_NO_BODY : z->held;
}

#endif
