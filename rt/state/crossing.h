/* SPDX-License-Identifier: Apache-2.0 */
/* Crossings of worlds with yarns (Metaaphanon 2009, sections 3.3 and 3.4). A crossing is whole: one
 * particle; or split, the paper's "couple": a particle of its weft, which is the old one, and one of its
 * warp, which is a spare one, each with half the mass. A split crossing is connected, loose or
 * disconnected.
 *
 *   whole -> loose -> disconnected                    two-level worlds
 *   connected -> loose -> disconnected                all-yarn worlds, except attached crossings
 *
 * An attached crossing stays whole: the body holds both yarns.
 *
 * crossing < capacity[POOL_CROSSINGS]; particle, p < p.count; spring < capacity[POOL_SPRINGS]. Every call
 * has constant cost. */
#ifndef FRAY_STATE_CROSSING_H
#define FRAY_STATE_CROSSING_H

#include "rt/state/world.h"

/* The byte of a crossing: its fray_crossing_state; CROSSING_PENDING: to be split or loosened, once the split
 * budget of a tick allows it; CROSSING_LEFT: one yarn slid off the other, so it is to be disconnected. */
enum { CROSSING_STATE = 3, CROSSING_LEFT = 64, CROSSING_PENDING = 128 };

static inline fray_crossing_state crossing_state_at(const fray_world *w, uint32_t crossing) {
  return (fray_crossing_state)(w->woven.crossing_state[crossing] & CROSSING_STATE);
}
static inline int crossing_is_attached(const fray_world *w, uint32_t crossing) {
  return w->woven.crossing_particle[crossing] < particles_attached(w);
}
/* 1 iff the particle is one yarn of a split crossing, with half its mass; worlds with yarns only. */
static inline int particle_is_half(const fray_world *w, uint32_t particle) {
  return crossing_state_at(w, w->woven.crossing_of[particle]) != FRAY_WHOLE;
}
/* Mass of a particle of any world, in halves of a whole particle's: 1 or 2; and its inverse, 2 or 1. */
static inline int32_t particle_half_masses(const fray_world *w, uint32_t p) {
  return world_has_yarns(w) && particle_is_half(w, p) ? 1 : 2;
}
static inline int32_t particle_inverse_mass(const fray_world *w, uint32_t p) {
  return world_has_yarns(w) && particle_is_half(w, p) ? 2 : 1;
}
/* The same, 0 of an attached one. */
static inline int32_t particle_free_inverse_mass(const fray_world *w, uint32_t p) {
  return p < particles_attached(w) ? 0 : particle_inverse_mass(w, p);
}
/* The contact of a split crossing (state/yarn_contact.h). */
static inline uint32_t crossing_contact(const fray_world *w, uint32_t crossing) {
  FRAY_ASSERT(crossing_state_at(w, crossing) != FRAY_WHOLE);
  return w->woven.warp_particle[crossing] - (uint32_t)w->params->particles;
}
/* 1 iff the warp is over the weft: on the side of the normal along warp x along weft. */
static inline int crossing_warp_over(const fray_world *w, uint32_t crossing) {
  const params *p = w->params;
  const uint32_t i = crossing % (uint32_t)p->warps % (uint32_t)p->weave_columns;
  const uint32_t j = crossing / (uint32_t)p->warps % (uint32_t)p->weave_rows;
  const uint32_t word = (uint32_t)(j < 4u ? p->weave_low : p->weave_high);
  return (int)(word >> (j % 4u * 8u + i) & 1u);
}

/* The kind byte of a living spring: its class, and which ends have half mass. */
uint8_t crossing_spring_kind(const fray_world *w, uint32_t spring);
/* The particles that a spring connects, by its canonical ends; either order. */
void crossing_spring_ends(const fray_world *w, uint32_t spring, uint32_t *a, uint32_t *b);

/* Splits a whole crossing that is not attached, to the state `to`: both yarns where it was, with its
 * velocity; springs go to their yarns (figure 5); their contact is at the crossing. The sums of mass times
 * position, remainder and velocity stay the same to the last bit. Returns 0 iff no spare particle is left:
 * then nothing changed. */
int crossing_split(fray_world *w, uint32_t crossing, fray_crossing_state to);
/* Changes the state of a split crossing to another; disconnecting releases the diagonals that end here. */
void crossing_set_state(fray_world *w, uint32_t crossing, fray_crossing_state to);
/* Kills the diagonals that end at a crossing. */
void crossing_release_diagonals(fray_world *w, uint32_t crossing);
/* Sets CROSSING_LEFT of a split crossing that is not disconnected, which is loose from now on. */
void crossing_set_left(fray_world *w, uint32_t crossing);
/* Sets CROSSING_PENDING iff pending, else clears it. */
void crossing_set_pending(fray_world *w, uint32_t crossing, int pending);

#endif
