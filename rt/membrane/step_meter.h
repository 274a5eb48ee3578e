/* SPDX-License-Identifier: Apache-2.0 */
/* What drag and constraints took and loads gave in an elastic step, for the energy ledger. */
#ifndef FRAY_MEMBRANE_STEP_METER_H
#define FRAY_MEMBRANE_STEP_METER_H

#include "rt/elastic/step_impulse.h"
#include "rt/simd/membrane_view.h"
#include "rt/state/world.h"

#if FRAY_ENERGY
void step_meter_damping_add(fray_world *w);
void step_meter_mark_add(fray_world *w, uint32_t mark);
void step_meter_zones_add(fray_world *w, const elastic_step *step);
void step_meter_add(fray_world *w, const step_view *view);
#endif

/* Behind the stress of a step, which is found once more without its damping. */
static inline void step_meter_damping(fray_world *w) {
#if FRAY_ENERGY
  if (__builtin_expect(w->energy.watched && w->energy.begun, 0)) step_meter_damping_add(w);
#else
  (void)w;
#endif
}

/* In a step: behind its forces (0), zones (1), repayment (2), lengths of edges (3), contact (4), rates of
 * edges (5) and self-collision (STEP_MARKS). */
static inline void step_meter_mark(fray_world *w, uint32_t mark) {
#if FRAY_ENERGY
  if (__builtin_expect(w->energy.watched && w->energy.begun, 0)) step_meter_mark_add(w, mark);
#else
  (void)w;
  (void)mark;
#endif
}

/* Behind zones, in the first step of a tick. */
static inline void step_meter_zones(fray_world *w, const elastic_step *step) {
#if FRAY_ENERGY
  if (__builtin_expect(w->energy.watched && w->energy.begun, 0)) step_meter_zones_add(w, step);
#else
  (void)w;
  (void)step;
#endif
}

/* Right after a step. */
static inline void step_meter(fray_world *w, const step_view *view) {
#if FRAY_ENERGY
  if (__builtin_expect(w->energy.watched && w->energy.begun, 0)) step_meter_add(w, view);
#else
  (void)w;
  (void)view;
#endif
}

#endif
