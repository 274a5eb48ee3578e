/* SPDX-License-Identifier: Apache-2.0 */
/* Handles in the elastic steps of a membrane: spring and damper between proxy and body. */
#ifndef FRAY_ELASTIC_STEP_HANDLES_H
#define FRAY_ELASTIC_STEP_HANDLES_H

#include "rt/elastic/step_impulse.h"

#if FRAY_HANDLES
/* Before the substeps of a tick, or of another attempt at it: proxies at the beginning of their
 * ways. Cost: constant. */
void step_handles_begin(fray_world *w);
/* Before step_bodies_pull(): the velocities that the step begins with, for the energy ledger. */
void step_handles_mark(fray_world *w);
/* Behind it: the impulses of one step, and the way of the proxies in it. part: of the elastic
 * steps of the tick, from 0. Cost: constant. */
void step_handles_pull(fray_world *w, const elastic_step *step, int32_t part);
#else
static inline void step_handles_begin(fray_world *w) { (void)w; }
static inline void step_handles_mark(fray_world *w) { (void)w; }
static inline void step_handles_pull(fray_world *w, const elastic_step *step, int32_t part) {
  (void)w;
  (void)step;
  (void)part;
}
#endif

#endif
