/* SPDX-License-Identifier: Apache-2.0 */
/* Sliding contacts of yarns (state/yarn_contact.h): what the stages around yarn_slip_apply() share. n is a
 * contact in use, below yarn_counts->split. */
#ifndef FRAY_WOVEN_YARN_SLIP_H
#define FRAY_WOVEN_YARN_SLIP_H

#include "rt/state/crossing.h"
#include "rt/woven/yarn_curve.h"

/* A contact gives way by kappa / 2 of the gap in a substep, for yarns of half a crossing's mass each: its
 * stiffness is kappa (m / 2) / h^2. Measured: energy falls for kappa up to 0.6. */
enum { YARN_SLIP_KAPPA = 13107, YARN_SLIP_KAPPA_BITS = 15 }; /* 0.4 */
/* Contacts of a yarn that are nearer than that push each other on along it: half a spacing, Q20. */
enum { YARN_SLIP_NEAR = YARN_PLACE_HALF };

/* Contacts act 2^bits times a substep: of elastic yarns in each second elastic step, of others behind the
 * projections. h is the time between. */
static inline unsigned yarn_slip_bits(const fray_world *w) {
  if (!world_has_elastic_yarns(w) || w->woven.elastic_params->steps_bits == 0) return 0;
  return (unsigned)w->woven.elastic_params->steps_bits - 1u;
}

static inline uint32_t yarn_contact_crossing(const fray_world *w, uint32_t n) {
  return w->woven.crossing_of[(uint32_t)w->params->particles + n];
}
/* 1 iff its yarns hold each other. */
static inline int yarn_contact_acts(const fray_world *w, uint32_t n) {
  const uint32_t c = yarn_contact_crossing(w, n);
  return crossing_state_at(w, c) != FRAY_DISCONNECTED && (w->woven.crossing_state[c] & CROSSING_LEFT) == 0;
}

/* Both yarns where they touch, by fray_axis, and the gap from weft to warp, Q24 lu: no component beyond
 * +-1/4 lu. Returns 0 iff one of the yarns has no link left there. Cost: constant. */
typedef struct {
  yarn_spot spot[2];
  vec3 gap;
} yarn_touch;
int yarn_slip_touch(const fray_world *w, uint32_t n, yarn_touch *touch);

/* From a contact to its neighbour in a direction (state/yarn_grid.h), Q20 spacings, at most some. Cost:
 * constant. */
int32_t yarn_slip_distance(const fray_world *w, uint32_t n, uint32_t direction);

/* 1 iff friction holds what a whole crossing carries from yarn to yarn: half of what the sums of their links'
 * forces differ by. Cost: as yarn_grip_update() of one contact. */
int yarn_grip_holds(const fray_world *w, uint32_t crossing);

/* The contact of a crossing that has just split: what its yarns are apart in bent cloth is its offset. Cost:
 * constant. */
void yarn_slip_begin(fray_world *w, uint32_t n);

#endif
