/* SPDX-License-Identifier: Apache-2.0 */
/* Haptic devices: poses and commands in, forces out. */
#ifndef FRAY_HAPTICS_HAPTICS_H
#define FRAY_HAPTICS_HAPTICS_H

#include "rt/state/world.h"

/* From a place to a target that is within the world, by at most a step. Q24 lu. */
static inline int32_t haptic_toward(int32_t from, int64_t target, int32_t step_max) {
  FRAY_ASSERT(step_max > 0);
  const int64_t bounded = fx_clamp_wide(target, FX_WORLD_MAX);
  return from + fx_clamp_wide(bounded - from, step_max);
}

/* At the begin of a tick: poses, commands, the state machine, and where driven bodies go in this tick. */
void haptic_device_update(fray_world *w, const fray_input *input);
/* At its end: momentum that the cloth gained from each hand's body, as a force, 0.5 mN a step. */
void haptic_force_update(fray_world *w, int16_t force[FRAY_HANDS][3]);

#endif
