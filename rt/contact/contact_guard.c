/* SPDX-License-Identifier: Apache-2.0 */
/* The guard behind the constraints of a membrane: a vertex that is inside a primitive by the end of
 * a substep, and deeper than when it began, is put back to that depth and goes on as the body does.
 * It is for what got fast within the substep; a move of positions beside the elastic steps stores
 * energy, so it must be rare. Where another body holds it there is no free place: a fault. */
#include "rt/contact/constraints.h"
#include "rt/contact/shape.h"
#include "rt/elastic/step_zone.h"
#include "rt/integrate/integrate.h"
#include "rt/state/vertex_mass.h"

static void stop_vertex(fray_world *w, uint32_t b, uint32_t p, vec3 normal,
                        const vertex_mass_scale *scale) {
  const vec3 velocity = world_velocity(w, p);
  const vec3 relative = vec_sub_saturated(velocity, vec_of(w->rigid.states[b].velocity));
  const vec3 change = vec_negated(vec_scale_unit(normal, vec_dot_unit(relative, normal)));
  world_set_velocity(w, p, vec_add_clamped(velocity, change, FX_SPEED_MAX));
  body_add_impulse(&w->rigid.motion[b], vertex_mass_impulse(vertex_mass_at(scale, p), change, 0));
}

static void guard_contact(fray_world *w, const contact *c, const vertex_mass_scale *scale) {
  const rigid_body *s = &w->rigid.bodies[c->body];
  const elastic_body *m = &w->membrane.bodies[c->body];
  const int32_t skin = w->params->thickness;
  const uint32_t held = step_body_of(w, c->particle);
  int32_t *at = w->membrane.positions[c->particle].at;
  const vec3 start = vec_sub(world_position(w, c->particle), m->start);
  vec3 normal, unused;
  const int32_t depth =
      shape_depth_at(s, contact_way_out_of(w, c->body, c->particle).whole, skin, &normal);
  if (depth <= skin) return;
  const int32_t allowed = fx_max(skin, shape_depth_at(s, start, skin, &unused));
  if (depth <= allowed) return;
  if (held != STEP_NO_BODY && held != c->body) {
    world_fault(w, FRAY_FAULT_CONTACT_UNRESOLVED);
    return;
  }
  const vec3 out =
      vec_scale_unit(normal, fx_saturate((int64_t)(depth - allowed) * (1 << FX_SUB_BITS)));
  at[0] = fx_wrap_add(at[0], out.x);
  at[1] = fx_wrap_add(at[1], out.y);
  at[2] = fx_wrap_add(at[2], out.z);
  stop_vertex(w, c->body, c->particle, normal, scale);
}

void contact_guard_apply(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w) && w->contact.gathered <= w->capacity[POOL_CONTACTS]);
  if (w->membrane.constraints_missed != 0) return;
  const vertex_mass_scale scale = vertex_mass_scale_of(w);
  for (uint32_t n = 0; n < w->contact.gathered; ++n) guard_contact(w, &w->contact.list[n], &scale);
  w->work.contacts += w->contact.gathered;
}
