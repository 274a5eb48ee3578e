/* SPDX-License-Identifier: Apache-2.0 */
/* Vertex mass used in contacts: boundary vertices of the membrane are lighter than interior ones, and a body
 * gets exactly the momentum that they gain. */
#ifndef FRAY_STATE_VERTEX_MASS_H
#define FRAY_STATE_VERTEX_MASS_H

#include "rt/state/world.h"

enum { VERTEX_MASS_BITS = 16, VERTEX_MASS_PER_BITS = 46 };

/* per_mass: Q46 of 1 / unit; 0: all particles weigh the same. */
typedef struct {
  const uint32_t *mass;
  uint32_t per_mass;
} vertex_mass_scale;

static inline vertex_mass_scale vertex_mass_scale_of(const fray_world *w) {
  const int uniform = !world_has_membrane(w);
  const uint64_t one = (uint64_t)1 << VERTEX_MASS_PER_BITS;
  const vertex_mass_scale h = {uniform ? 0 : w->trimesh.mass,
                               uniform ? 0 : fx_divide_wide(one, (uint32_t)w->membrane.constants->mass_unit)};
  return h;
}

/* Q16 of particle_mass, of a membrane. */
static inline int32_t vertex_mass_at(const vertex_mass_scale *h, uint32_t p) {
  FRAY_ASSERT(h->per_mass != 0);
  const uint64_t whole = (uint64_t)h->mass[p] * h->per_mass >> (VERTEX_MASS_PER_BITS - VERTEX_MASS_BITS);
  return whole > INT32_MAX ? INT32_MAX : (int32_t)whole;
}

/* Momentum of a mass at a speed, in `more` bits more than the speed has. */
static inline int64_t vertex_mass_times(int32_t mass, int32_t speed, unsigned more) {
  return fx_round64(fx_mul_wide(mass, speed), VERTEX_MASS_BITS - more);
}
static inline vec64 vertex_mass_impulse(int32_t mass, vec3 speed, unsigned more) {
  const vec64 impulse = {vertex_mass_times(mass, speed.x, more), vertex_mass_times(mass, speed.y, more),
                         vertex_mass_times(mass, speed.z, more)};
  return impulse;
}

#endif
