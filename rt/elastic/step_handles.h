/* SPDX-License-Identifier: Apache-2.0 */
/* Handles in the elastic steps of a membrane: spring and damper between proxy and body. */
#ifndef FRAY_ELASTIC_STEP_HANDLES_H
#define FRAY_ELASTIC_STEP_HANDLES_H

#include "rt/elastic/step_impulse.h"

#if FRAY_HANDLES
/* Before the substeps of a tick, or of another attempt at it: proxies at the beginning of their
 * ways. Cost: constant. */
void step_handles_begin(fray_world *w);
/* Behind step_bodies_pull(): the impulses of one step, and the way of the proxies in it. part: of the elastic
 * steps of the tick, from 0. Cost: constant. */
void step_handles_pull(fray_world *w, const elastic_step *step, int32_t part);
#else
static inline void step_handles_begin(fray_world *w) { (void)w; }
static inline void step_handles_pull(fray_world *w, const elastic_step *step, int32_t part) {
  (void)w;
  (void)step;
  (void)part;
}
#endif

#if FRAY_HANDLES && FRAY_ENERGY
void step_handles_mark_add(fray_world *w);
void step_handles_meter_add(fray_world *w);
#endif

/* For the energy ledger: before step_bodies_pull(), the velocities that the step begins with; and behind all
 * impulses of the step, the work of hands and what dampers took. */
static inline void step_handles_mark(fray_world *w) {
  (void)w;
#if FRAY_HANDLES && FRAY_ENERGY
  if (__builtin_expect(w->energy.watched && world_has_handles(w), 0)) step_handles_mark_add(w);
#endif
}
static inline void step_handles_meter(fray_world *w) {
  (void)w;
#if FRAY_HANDLES && FRAY_ENERGY
  if (__builtin_expect(w->energy.watched && world_has_handles(w), 0)) step_handles_meter_add(w);
#endif
}

#endif
