/* SPDX-License-Identifier: Apache-2.0 */
/* Contact of elastic yarns with spheres, capsules, boxes and planes at the velocity, in each elastic step. A
 * push of positions once a substep, beside steps that know nothing of it, stores k d^2 / 2 in the links
 * around each particle that it moves by d. So a particle that would pass the surface in this step gets the
 * impulse along the normal n that stops it there, and friction within the Coulomb cone; from inside it comes
 * out at STEP_RISE_UM_S at most.
 *
 * With velocities v- before the pull of a step and v+ behind the impulse, relative to the body, the energy of
 * the leapfrog step changes by lambda n.(v- + v+) / 2. n.v+ is -gap / dt, and the gap is that of the step
 * before plus n.v- dt: so it changes by -lambda / 2 dt times the gap of the step before, not above 0. A
 * contact takes energy, and gives no more than the work of its body. */
#include "rt/contact/contact.h"
#include "rt/contact/shape.h"
#include "rt/elastic/step_impulse.h"
#include "rt/integrate/integrate.h"
#include "rt/state/crossing.h"

/* Where the body is before step n. */
static vec3 body_at_step(const fray_world *w, uint32_t b, int32_t n, unsigned bits) {
  const vec3 moved = w->rigid.motion[b].moved;
  const vec3 left = bits == 0 ? moved : vec_round_saturated(vec_scale64(moved, (1 << bits) - n), bits);
  return vec_sub(vec_of(w->rigid.states[b].position), left);
}

/* Q16 of a particle's mass: of the particle and a free body together. */
static int32_t contact_mass(const fray_world *w, uint32_t b, uint32_t p) {
  const uint64_t of_body = (uint64_t)(uint32_t)w->rigid.bodies[b].mass_ratio >> 6;
  return step_mass_of(((uint64_t)particle_inverse_mass(w, p) << 24) + of_body);
}

static void solve_step(fray_world *w, const contact *c, const yarn_step *step) {
  const uint32_t p = c->particle;
  const uint32_t b = c->body;
  const int32_t margin = w->params->contact_margin;
  const vec3 d = vec_sub(world_position(w, p), body_at_step(w, b, step->number, step->bits));
  vec3 normal;
  const int32_t depth =
      shape_depth_at(&w->rigid.bodies[b], d, fx_add(w->params->thickness, margin), &normal);
  if (depth <= 0) return;
  const int32_t gap = fx_saturate((int64_t)(margin - depth) * (1 << FX_SUB_BITS));
  const int32_t least = step_speed_min(gap, 1 << step->bits, step->rise);
  const vec3 velocity = world_velocity(w, p);
  const vec3 body = vec_of(w->rigid.states[b].velocity);
  const vec3 relative = vec_sub_saturated(vec_add_clamped(velocity, step->gravity, INT32_MAX), body);
  const vec3 change = step_contact_change(relative, normal, least, w->rigid.bodies[b].friction);
  if (vec_span(change) == 0) return;
  const vec3 impulse = vec_round_clamped(vec_scale64(change, contact_mass(w, b, p)), STEP_MASS_BITS,
                                         FX_SPEED_MAX / 2);
  const vec3 gained = vec_mul(impulse, particle_inverse_mass(w, p));
  world_set_velocity(w, p, vec_add_clamped(velocity, gained, FX_SPEED_MAX));
  const vec64 whole = {impulse.x, impulse.y, impulse.z};
  body_add_impulse(&w->rigid.motion[b], whole);
  if (w->rigid.bodies[b].motion == FRAY_FREE) body_update_velocity(w, b);
}

void contact_steps_solve(fray_world *w, const yarn_step *step) {
  FRAY_ASSERT(world_has_elastic_yarns(w) && step->number >= 0 && step->number < 1 << step->bits);
  for (uint32_t n = 0; n < w->contact.gathered; ++n) solve_step(w, &w->contact.list[n], step);
  w->work.contacts += w->contact.gathered;
}
