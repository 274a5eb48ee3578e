/* SPDX-License-Identifier: Apache-2.0 */
/* Crossings of worlds with yarns (Metaaphanon 2009, sections 3.3 and 3.4). A crossing is whole: one
 * particle; or a couple: a particle of its weft, which is the old one, and one of its warp, which is a
 * spare one, each with half the mass. A couple is connected, loose or disconnected.
 *
 *   whole -> loose -> disconnected                    two-level worlds
 *   connected -> loose -> disconnected                all-yarn worlds, but for held crossings
 *
 * A held crossing stays whole: what grips it holds both yarns, and the weave with them. */
#ifndef FRAY_MODEL_COUPLES_H
#define FRAY_MODEL_COUPLES_H

#include "rt/model/world.h"

/* Beside the fray_couple of a crossing: it is to be split, but the tick's splits were used up. */
enum { COUPLE_STATE = 3, COUPLE_WANTED = 128 };

static inline fray_couple couple_at(const fray_world *w, uint32_t crossing) {
  return (fray_couple)(w->couple[crossing] & COUPLE_STATE);
}
static inline int couple_is_held(const fray_world *w, uint32_t crossing) {
  return w->crossing[crossing] < (uint32_t)w->params->held;
}
/* 1 iff the particle is one yarn of a crossing, with half its mass; worlds with yarns only. */
static inline int couple_is_light(const fray_world *w, uint32_t particle) {
  return couple_at(w, w->place[particle]) != FRAY_WHOLE;
}
/* 1 iff the warp is over the weft: on the side of the normal along warp x along weft. */
static inline int couple_warp_over(const fray_world *w, uint32_t crossing) {
  const params *p = w->params;
  const uint32_t i = crossing % (uint32_t)p->warps % (uint32_t)p->weave_columns;
  const uint32_t j = crossing / (uint32_t)p->warps % (uint32_t)p->weave_rows;
  const uint32_t word = (uint32_t)(j < 4u ? p->weave_low : p->weave_high);
  return (int)(word >> (j % 4u * 8u + i) & 1u);
}

/* The kind that a living row has: its class, and which ends are light. */
uint8_t couple_kind(const fray_world *w, uint32_t row);
/* The particles that a row is between, by its canonical ends; either order. */
void couple_ends(const fray_world *w, uint32_t row, uint32_t *a, uint32_t *b);
/* The normal of the cloth at a crossing, Q30 (section 3.3, figure 3a): of the four triangles around
 * it, weighted by their areas. */
vec3 couple_normal(const fray_world *w, uint32_t crossing);

/* Splits a whole crossing that is not held (equations 2 to 4): positions half a thickness to both
 * sides along the normal, velocities the same; rows go to their yarns (figure 5). The sums of mass
 * times position, remainder and velocity stay the same to the last bit.
 * Returns 0 iff no spare particle is left: then nothing changed. */
int couple_split(fray_world *w, uint32_t crossing, fray_couple to);
/* Any other transition; disconnecting releases the diagonals that end here. */
void couple_change(fray_world *w, uint32_t crossing, fray_couple to);
/* Marks a crossing as one to be split or loosened, or takes the mark away. */
void couple_want(fray_world *w, uint32_t crossing, int wanted);

#endif
