/* SPDX-License-Identifier: Apache-2.0 */
/* Velocities where particles touch bodies (Metaaphanon 2009, section 4, step 8, after Mueller et al. 2007): a
 * touching particle keeps no velocity away from the body that the push-out gave it. */
#include "rt/contact/contact.h"

#include "rt/state/crossing.h"

/* Removes the speed away from the body. A particle of half mass loses an even speed, so that the
 * momentum, in whole particles, is a whole number too. */
static void stop_separation(fray_world *w, const contact *c) {
  const uint32_t p = c->particle;
  const vec3 velocity = world_velocity(w, p);
  const vec3 away = vec_sub_saturated(velocity, vec_of(w->rigid.states[c->body].velocity));
  const int32_t speed = vec_dot_unit(away, c->normal);
  if (speed <= 0) return;
  const int32_t inverse_mass = particle_inverse_mass(w, p);
  const vec3 lost = vec_scale_unit(c->normal, speed / inverse_mass);
  world_set_velocity(w, p, vec_sub_clamped(velocity, vec_mul(lost, inverse_mass), FX_SPEED_MAX));
  body_take_impulse(&w->rigid.motion[c->body], lost);
}

/* The same where the normal is (0, 1, 0). */
static void stop_separation_ground(fray_world *w, const contact *c) {
  const uint32_t p = c->particle;
  const int32_t speed = fx_saturate((int64_t)w->p.vy[p] - w->rigid.states[c->body].velocity[1]);
  if (speed <= 0) return;
  const int32_t inverse_mass = particle_inverse_mass(w, p);
  const int32_t lost = speed / inverse_mass;
  w->p.vy[p] = fx_clamp_wide((int64_t)w->p.vy[p] - lost * inverse_mass, FX_SPEED_MAX);
  const vec64 down = {0, -(int64_t)lost, 0};
  body_add_impulse(&w->rigid.motion[c->body], down);
}

void contact_update_velocity_range(fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first <= end && end <= w->contact.count);
  for (uint32_t n = first; n < end; ++n) {
    const contact *c = &w->contact.list[n];
    FRAY_ASSERT(c->particle < w->p.count && c->body < w->capacity[POOL_BODIES]);
    if (!FX_NARROW && c->touching == CONTACT_GROUND)
      stop_separation_ground(w, c);
    else if (c->touching != CONTACT_APART)
      stop_separation(w, c);
  }
}

void contact_update_velocity(fray_world *w) { contact_update_velocity_range(w, 0, w->contact.count); }
