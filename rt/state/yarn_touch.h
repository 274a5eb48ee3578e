/* SPDX-License-Identifier: Apache-2.0 */
/* Where the yarns of a split crossing touch, and how their contact acts (woven/yarn_slip.c). n: a contact in
 * use, below yarn_counts->split. */
#ifndef FRAY_STATE_YARN_TOUCH_H
#define FRAY_STATE_YARN_TOUCH_H

#include "rt/state/crossing.h"
#include "rt/state/yarn_curve.h"

enum { YARN_GAP_MAX = FX_LU / 4 }; /* each component, Q24 lu */

/* The stiffness of a contact is kappa (m / 2) / h^2, of yarns of half a crossing's mass m each. Measured:
 * energy falls for kappa up to 0.6. */
enum { YARN_SLIP_KAPPA = 13107, YARN_SLIP_KAPPA_BITS = 15 }; /* 0.4 */

/* Contacts act 2^bits times a substep: of elastic yarns in each elastic step, of others behind the
 * projections. h is the time between. */
static inline unsigned yarn_slip_bits(const fray_world *w) {
  return world_has_elastic_yarns(w) ? (unsigned)w->woven.elastic_params->steps_bits : 0u;
}

/* kappa, Q15: elastic yarns have many passes, and softer contacts share their loads more evenly. */
static inline int32_t yarn_slip_kappa(const fray_world *w) {
  return world_has_elastic_yarns(w) ? YARN_SLIP_KAPPA / 4 : YARN_SLIP_KAPPA;
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
int yarn_touch_at(const fray_world *w, uint32_t n, yarn_touch *touch);

/* The gap of a touch whose spots are known. */
vec3 yarn_touch_gap(const yarn_touch *touch, const yarn_contact *c);

#endif
