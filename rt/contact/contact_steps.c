/* SPDX-License-Identifier: Apache-2.0 */
/* Contact of elastic yarns with bodies, and of free bodies with planes, at the velocity, in each elastic
 * step. A push of positions once a substep, beside steps that know nothing of it, stores k d^2 / 2 in the
 * links around each particle that it moves by d. So a particle that would pass the surface in this step gets
 * the impulse along the normal n that stops it there, and friction within the Coulomb cone.
 *
 * With velocities v- before the pull of a step and v+ behind the impulse, relative to the body, the energy of
 * the leapfrog step changes by lambda n.(v- + v+) / 2. n.v+ is -gap / dt, and the gap is that of the step
 * before plus n.v- dt: so it changes by -lambda / 2 dt times the gap of the step before, not above 0. From
 * inside a primitive it comes out as fast as it came, n.v+ is -n.v- at most, and at STEP_RISE_UM_S. A contact
 * takes energy, and gives no more than the work of its body. */
#include "rt/contact/contact.h"
#include "rt/contact/shape.h"
#include "rt/elastic/step_passive.h"
#include "rt/integrate/integrate.h"
#include "rt/state/crossing.h"

/* Where the body is before step n: a free one has come no farther. */
static vec3 body_at_step(const fray_world *w, uint32_t b, int32_t n, unsigned bits) {
  const vec3 moved = w->rigid.motion[b].moved;
  if (w->rigid.bodies[b].motion == FRAY_FREE) return vec_of(w->rigid.states[b].position);
  const vec3 left = bits == 0 ? moved : vec_round_saturated(vec_scale64(moved, (1 << bits) - n), bits);
  return vec_sub(vec_of(w->rigid.states[b].position), left);
}

/* Q16 of a particle's mass: of the particle and a free body together. */
static int32_t contact_mass(const fray_world *w, uint32_t b, uint32_t p) {
  const uint64_t of_body = (uint64_t)(uint32_t)w->rigid.bodies[b].mass_ratio >> 6;
  return step_mass_of(((uint64_t)particle_inverse_mass(w, p) << 24) + of_body);
}

static vec3 with_gravity(vec3 velocity, const yarn_step *step) {
  return vec_add_clamped(velocity, step->gravity, INT32_MAX);
}

static vec3 body_velocity_in_step(const fray_world *w, uint32_t b, const yarn_step *step) {
  const vec3 velocity = vec_of(w->rigid.states[b].velocity);
  return w->rigid.bodies[b].motion == FRAY_FREE ? with_gravity(velocity, step) : velocity;
}

static vec3 relative_velocity(const fray_world *w, const contact *c, const yarn_step *step) {
  return vec_sub_saturated(with_gravity(world_velocity(w, c->particle), step),
                           body_velocity_in_step(w, c->body, step));
}

/* Away from a surface at this height, Q24 lu. */
static int32_t least_speed(int64_t height, const yarn_step *step) {
  return step_speed_min(fx_saturate(height * (1 << FX_SUB_BITS)), 1 << step->bits, step->rise);
}

/* A free body on a plane. */
static void solve_plane(fray_world *w, uint32_t b, uint32_t g, const yarn_step *step) {
  const rigid_body *plane = &w->rigid.bodies[g];
  const vec3 normal = shape_plane_normal(plane);
  const vec3 at = body_at_step(w, g, step->number, step->bits);
  const int64_t height = contact_height_above(w, b, vec_of(w->rigid.states[b].position), g, at);
  const vec3 relative =
      vec_sub_saturated(body_velocity_in_step(w, b, step), vec_of(w->rigid.states[g].velocity));
  const vec3 change = step_contact_change(relative, normal, least_speed(height, step), plane->friction);
  int32_t *velocity = w->rigid.states[b].velocity;
  vec_store(velocity, vec_add_clamped(vec_of(velocity), change, INT32_MAX));
}

static void solve_planes(fray_world *w, uint32_t b, const yarn_step *step) {
  for (uint32_t g = 0; g < (uint32_t)w->params->bodies; ++g)
    if (shape_is_plane(&w->rigid.bodies[g])) solve_plane(w, b, g, step);
}

/* Stops a particle at a body, along the normal and, by friction, across it. */
static void stop_particle(fray_world *w, const contact *c, vec3 normal, int32_t least,
                          const yarn_step *step) {
  const uint32_t p = c->particle;
  const uint32_t b = c->body;
  const vec3 velocity = world_velocity(w, p);
  const vec3 relative = relative_velocity(w, c, step);
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

static vec3 from_body(const fray_world *w, const contact *c, const yarn_step *step) {
  return vec_sub(world_position(w, c->particle), body_at_step(w, c->body, step->number, step->bits));
}

/* Of the particle, less what a body gains that falls with it. */
static vec3 half_of_forces(const fray_world *w, const contact *c, const yarn_step *step) {
  if (w->rigid.bodies[c->body].motion == FRAY_FREE) return c->normal;
  return vec_add_clamped(c->normal, vec_asr(step->gravity, 1), INT32_MAX);
}

static void solve_primitive(fray_world *w, const contact *c, const yarn_step *step) {
  const int32_t margin = w->params->contact_margin;
  vec3 normal;
  const int32_t depth = shape_depth_at(&w->rigid.bodies[c->body], from_body(w, c, step),
                                       fx_add(w->params->thickness, margin), &normal);
  if (depth <= 0) return;
  int32_t least = least_speed(margin - depth, step);
  if (least > 0)
    least = step_passive_speed(least, vec_dot_unit(relative_velocity(w, c, step), normal),
                               vec_dot_unit(half_of_forces(w, c, step), normal));
  stop_particle(w, c, normal, least, step);
}

/* Of a mesh: a plane, for the substep. What is nearer than its thickness comes no nearer. */
static void solve_plane_of_mesh(fray_world *w, uint32_t n, const yarn_step *step) {
  const contact *c = &w->contact.list[n];
  const contact_state *s = &w->contact;
  const vec3 from = vec_at(s->start_x, s->start_y, s->start_z, c->particle);
  const vec3 begin = vec_sub(from, w->rigid.start[c->body]);
  const int64_t moved = vec_dot_unit(vec_sub(from_body(w, c, step), begin), c->normal);
  const int32_t least = least_speed(contact_gap_of(c->plane_gap) + moved, step);
  stop_particle(w, c, c->normal, fx_min(0, least), step);
}

void contact_steps_mark(fray_world *w) {
  for (uint32_t n = 0; n < w->contact.gathered; ++n)
    w->contact.list[n].normal = world_velocity(w, w->contact.list[n].particle);
}

/* c->normal: half of what changes the particle's velocity before contact. */
void contact_steps_pulled(fray_world *w) {
  for (uint32_t n = 0; n < w->contact.gathered; ++n) {
    contact *c = &w->contact.list[n];
    c->normal = vec_asr(vec_sub_saturated(world_velocity(w, c->particle), c->normal), 1);
  }
}

void contact_steps_solve(fray_world *w, const yarn_step *step) {
  FRAY_ASSERT(world_has_elastic_yarns(w) && step->number >= 0 && step->number < 1 << step->bits);
  for (uint32_t n = 0; n < w->contact.gathered; ++n) solve_primitive(w, &w->contact.list[n], step);
  for (uint32_t n = w->contact.gathered; n < w->contact.count; ++n) solve_plane_of_mesh(w, n, step);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->rigid.bodies[b].motion == FRAY_FREE) solve_planes(w, b, step);
  w->work.contacts += w->contact.count;
}
