/* SPDX-License-Identifier: Apache-2.0 */
/* A zone that is put together behind the elastic steps takes its vertices back along paths that
 * their neighbours have gone: that stores k d^2 / 2 in the triangles between. So the tick is done
 * again with its vertices as one body: in each elastic step all of them get the mean velocity, or
 * that of the body that holds one. Of all motions that agree within the zone it is the nearest, by
 * masses; so it takes kinetic energy, and no frequency of the cloth rises by it (Rayleigh). */
#include "rt/self_collision/impact_zone_steps.h"

#include "rt/self_collision/impact_zones.h"
#include "rt/state/vertex_mass.h"

enum { MASS_MAX = 1 << 24, MASS_BITS = VERTEX_MASS_BITS };

static int32_t mass_of(const vertex_mass_scale *scale, uint32_t p) {
  return fx_clamp(vertex_mass_at(scale, p), 1, MASS_MAX);
}

static uint32_t body_of(const fray_world *w, uint32_t p) {
  if (particle_is_attached(w, p)) return w->p.attach_body[p];
  return w->attempt.vertices[p].joined_body == 0 ? STEP_NO_BODY
                                                 : w->attempt.vertices[p].joined_body - 1u;
}

static void find_bodies(fray_world *w) {
  static const self_zone empty = {{0, 0, 0}, 0, {0, 0, 0}, 0, 0, STEP_NO_BODY};
  for (uint32_t p = 0; p < w->p.count; ++p) w->self.zones[p] = empty;
  for (uint32_t p = 0; p < w->p.count; ++p) {
    self_zone *z = &w->self.zones[impact_zones_joined(w, p)];
    const uint32_t body = body_of(w, p);
    ++z->members;
    if (z->held == STEP_NO_BODY) z->held = body;
  }
}

/* Momentum of its vertices as seen from its body. */
static void sum_momentum(fray_world *w, const elastic_step *step) {
  const vertex_mass_scale scale = vertex_mass_scale_of(w);
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    self_zone *z = &w->self.zones[impact_zones_joined(w, p)];
    const vec3 v = vec_sub_saturated(step_velocity(w, p, step), step_body_velocity(w, z->held));
    const int32_t mass = mass_of(&scale, p);
    z->whole += mass;
    z->sum[0] += fx_round64(fx_mul_wide(v.x, mass), MASS_BITS);
    z->sum[1] += fx_round64(fx_mul_wide(v.y, mass), MASS_BITS);
    z->sum[2] += fx_round64(fx_mul_wide(v.z, mass), MASS_BITS);
  }
}

/* Momentum over mass, Q28 over Q16. */
static int32_t speed_of(int64_t momentum, int64_t mass) {
  const int64_t whole = momentum / mass;
  const int64_t rest = momentum - whole * mass;
  return fx_saturate(whole * (1 << MASS_BITS) + rest * (1 << MASS_BITS) / mass);
}

/* The velocity that it goes on with: with a free body that of their common mass. */
static void find_mean(const fray_world *w, self_zone *z) {
  enum { BODY_MASS_MAX_BITS = 46 };
  const vec3 velocity = step_body_velocity(w, z->held);
  const int32_t of_body[3] = {velocity.x, velocity.y, velocity.z};
  const int32_t ratio = z->held == STEP_NO_BODY ? 0 : w->rigid.bodies[z->held].mass_ratio;
  int64_t mass = z->whole;
  if (ratio != 0) mass += ((int64_t)1 << BODY_MASS_MAX_BITS) / ratio;
  for (uint32_t k = 0; k < 3; ++k) {
    const int32_t gained = z->held != STEP_NO_BODY && ratio == 0 ? 0 : speed_of(z->sum[k], mass);
    z->mean[k] = fx_add_saturated(of_body[k], gained);
  }
}

static int64_t impulse_of(int32_t change, int32_t inverse) {
  enum { UP = ELASTIC_IMPULSE_BITS + ELASTIC_INVERSE_BITS - FX_VELOCITY_BITS };
  return (int64_t)change * (1 << UP) / inverse;
}

static void push_vertex(fray_world *w, uint32_t p, const self_zone *z, const elastic_step *step) {
  const vec3 velocity = step_velocity(w, p, step);
  const vec3 change = vec_sub_saturated(vec_of(z->mean), velocity);
  const int32_t inverse = w->membrane.inverse_mass[p];
  if (vec_span(change) == 0 || inverse == 0) return;
  const vec64 impulse = {impulse_of(change.x, inverse), impulse_of(change.y, inverse),
                         impulse_of(change.z, inverse)};
  step_push_body(w, z->held, step_push(w, p, impulse));
}

void impact_zone_steps_solve(fray_world *w, const elastic_step *step) {
  if (!world_has_triangle_collision(w) || !w->attempt.begin->joined_any) return;
  find_bodies(w);
  sum_momentum(w, step);
  for (uint32_t p = 0; p < w->p.count; ++p)
    if (w->self.zones[p].whole != 0) find_mean(w, &w->self.zones[p]);
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    const self_zone *z = &w->self.zones[impact_zones_joined(w, p)];
    if (z->members > 1 || z->held != STEP_NO_BODY) push_vertex(w, p, z, step);
  }
}
