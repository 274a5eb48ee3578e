/* SPDX-License-Identifier: Apache-2.0 */
/* Particles: velocities gain gravity, positions gain velocities (Metaaphanon 2009, section 4, steps 1, 2 and
 * 4: explicit Euler); at the end of a substep velocities take over what projections and collisions did to
 * the positions (step 8, after Mueller et al. 2007). */
#include "rt/integrate/integrate.h"
#include "rt/simd/simd.h"

/* Particles that are not attached, and in use. */
__attribute__((unused)) static int are_free(const fray_world *w, uint32_t first, uint32_t end) {
  return first >= particles_attached(w) && first <= end && end <= w->p.count;
}

void particles_advance_range(fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(are_free(w, first, end));
  const fray_kernel kernel = w->kernel;
  uint32_t at_edge = simd_advance(kernel, w->p.x, w->p.qx, w->p.vx, w->p.rx, first, end, w->gravity_step.x);
  at_edge |= simd_advance(kernel, w->p.y, w->p.qy, w->p.vy, w->p.ry, first, end, w->gravity_step.y);
  at_edge |= simd_advance(kernel, w->p.z, w->p.qz, w->p.vz, w->p.rz, first, end, w->gravity_step.z);
  if (at_edge != 0) world_fault(w, FRAY_FAULT_OUT_OF_WORLD);
  w->work.particle_steps += end - first;
}

void particles_advance(fray_world *w) { particles_advance_range(w, particles_attached(w), w->p.count); }

/* A body may be faster than a particle can be. */
static vec3 carried_velocity(const body_state *s) {
  return vec_clamp_rare(vec_of(s->velocity), FX_SPEED_MAX);
}

static void carry(fray_world *w, uint32_t p, const body_state *s) {
  const int32_t *at = s->position;
  w->p.x[p] = w->p.qx[p] = loop_carried(at[0], w->p.attach_x[p]);
  w->p.y[p] = w->p.qy[p] = loop_carried(at[1], w->p.attach_y[p]);
  w->p.z[p] = w->p.qz[p] = loop_carried(at[2], w->p.attach_z[p]);
  world_set_velocity(w, p, carried_velocity(s));
}

static void carry_run(fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(end <= particles_attached(w) && w->p.attach_body[first] < w->capacity[POOL_BODIES]);
  const fray_kernel kernel = w->kernel;
  const body_state *s = &w->rigid.states[w->p.attach_body[first]];
  const int32_t *at = s->position;
  const vec3 velocity = carried_velocity(s);
  simd_carry(kernel, w->p.x, w->p.qx, w->p.vx, w->p.attach_x, first, end, at[0], velocity.x);
  simd_carry(kernel, w->p.y, w->p.qy, w->p.vy, w->p.attach_y, first, end, at[1], velocity.y);
  simd_carry(kernel, w->p.z, w->p.qz, w->p.vz, w->p.attach_z, first, end, at[2], velocity.z);
}

/* Particles that one body holds follow one another, as a rule: wide cores take them together. */
void particles_carry(fray_world *w) {
  const uint32_t held = particles_attached(w);
  FRAY_ASSERT(held <= w->p.count);
  for (uint32_t p = 0; p < held;) {
    if (FX_NARROW) {
      carry(w, p, &w->rigid.states[w->p.attach_body[p]]);
      ++p;
    } else {
      const uint32_t first = p;
      do ++p;
      while (p < held && w->p.attach_body[p] == w->p.attach_body[first]);
      carry_run(w, first, p);
    }
  }
}

void particles_update_velocity_range(fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(are_free(w, first, end));
  simd_velocity(w->kernel, w->p.x, w->p.qx, w->p.vx, first, end);
  simd_velocity(w->kernel, w->p.y, w->p.qy, w->p.vy, first, end);
  simd_velocity(w->kernel, w->p.z, w->p.qz, w->p.vz, first, end);
}

void particles_update_velocity(fray_world *w) {
  particles_update_velocity_range(w, particles_attached(w), w->p.count);
}

static void hold_axis(int32_t *at, const int32_t *end) {
  for (; at != end; ++at)
    if (__builtin_expect(fx_clamp_rare(*at, -FX_EDGE_MAX, FX_EDGE_MAX) != *at, 0))
      *at = *at < 0 ? -FX_EDGE_MAX : FX_EDGE_MAX;
}

void particles_hold_range(fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(are_free(w, first, end));
  hold_axis(w->p.x + first, w->p.x + end);
  hold_axis(w->p.y + first, w->p.y + end);
  hold_axis(w->p.z + first, w->p.z + end);
}

void particles_hold(fray_world *w) { particles_hold_range(w, particles_attached(w), w->p.count); }
