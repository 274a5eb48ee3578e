/* SPDX-License-Identifier: Apache-2.0 */
/* The net behind the coupling: what a device was given since START, in whole nanojoules. */
#ifndef FRAY_HAPTICS_PASSIVITY_H
#define FRAY_HAPTICS_PASSIVITY_H

#include "rt/state/world.h"

#if FRAY_HANDLES
/* Counts the work of the forces that moved the hands to their poses, and changes those of this
 * tick, before clamp and rate limit, where they would give more than the reserves. 0.5 mN a step.
 */
void passivity_control(fray_world *w, int32_t force[FRAY_HANDS][3]);
/* What was sent to hand h. */
void passivity_remember(fray_world *w, uint32_t h, const int32_t sent[3]);
#else
static inline void passivity_control(fray_world *w, int32_t force[FRAY_HANDS][3]) {
  (void)w;
  (void)force;
}
static inline void passivity_remember(fray_world *w, uint32_t h, const int32_t sent[3]) {
  (void)w;
  (void)h;
  (void)sent;
}
#endif

#endif
