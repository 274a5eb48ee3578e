/* SPDX-License-Identifier: Apache-2.0 */
/* Energies of a world as it is now, in masses of a particle times (lu per substep)^2. */
#ifndef FRAY_ENERGY_ENERGY_MEASURE_H
#define FRAY_ENERGY_ENERGY_MEASURE_H

#include "rt/state/world.h"

#if FRAY_ENERGY
/* Motion of particles and bodies, and height: motion, bodies, potential, held. */
void energy_measure_motion(const fray_world *w, energy_stored *e);
/* Elastic energies, form and pull, by the model; positions alone change them, but for form, which
 * follows the velocities of the moment too. Of a membrane this uses the arrays of its elastic
 * steps, which begin anew. */
void energy_measure_woven(const fray_world *w, energy_stored *e);
/* Of the contact of two elastic yarns, whose gap it is. */
wide_number energy_of_contact(const fray_world *w, vec3 gap);
void energy_measure_membrane(fray_world *w, energy_stored *e);

/* Q28 lu per substep. While positions are off their predictions, what the velocity will be: as
 * particles_update_velocity() computes it, without its limit. */
static inline vec3 energy_velocity(const fray_world *w, uint32_t p) {
  enum { MOST = 3 << 29 }; /* three squares fit 63 bits */
  const vec3 v = world_velocity(w, p);
  if (!w->energy.displaced) return v;
  const vec64 moved = {(int64_t)w->p.x[p] - w->p.qx[p], (int64_t)w->p.y[p] - w->p.qy[p],
                       (int64_t)w->p.z[p] - w->p.qz[p]};
  const vec64 sum = {v.x + moved.x * (1 << FX_SUB_BITS), v.y + moved.y * (1 << FX_SUB_BITS),
                     v.z + moved.z * (1 << FX_SUB_BITS)};
  return vec_clamp64(sum, MOST);
}

/* Bend and shear springs of woven cloth act once in so many substeps (rt/tick/tick_woven.c), and so many
 * moves of particles. */
static inline int32_t energy_spring_substeps(const fray_world *w) {
  return world_has_elastic_yarns(w) ? 1 : w->params->substeps;
}
static inline int32_t energy_spring_moves(const fray_world *w) {
  return world_has_elastic_yarns(w) ? 1 << w->woven.elastic_params->steps_bits : w->params->substeps;
}

/* Mass of a particle, Q20 of particle_mass_ng, at most 1,024 of it. */
enum { ENERGY_MASS_BITS = 20 };
int64_t energy_mass(const fray_world *w, uint32_t p);
#endif

#endif
