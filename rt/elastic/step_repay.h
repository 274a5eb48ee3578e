/* SPDX-License-Identifier: Apache-2.0 */
/* Energy that is owed, as a stiffness that changed has made it, is taken from a motion. With v velocities of
 * some vertices, c of step_passive.h, u the sum of along . (v - c), and m = 1 / sum of |along|^2 / mass: an
 * impulse J on each along its vector leaves u' = u + J / m, and takes m (u^2 - u'^2) / 2. So a damper pays
 * what time domain passivity asks for (Hannaford, Ryu 2002). */
#ifndef FRAY_ELASTIC_STEP_REPAY_H
#define FRAY_ELASTIC_STEP_REPAY_H

#include "rt/elastic/step_passive.h"

enum { STEP_MOTION_BITS = 28, STEP_MOTION_VERTICES = 4 };

/* Vectors within 2, Q28, that add up to 0 but for rounding. */
typedef struct {
  uint32_t count; /* 2 to STEP_MOTION_VERTICES */
  uint32_t vertex[STEP_MOTION_VERTICES];
  vec3 along[STEP_MOTION_VERTICES];
} step_motion;

/* What energies of a particle's mass times lu^2 / substep^2 are multiplied by: `by` 2^-bits, where `by` is
 * below 2^31. */
typedef struct {
  uint32_t by;
  int bits;
} step_energy_unit;

/* 1 / v as `by` 2^-bits, v not 0. */
step_energy_unit step_energy_unit_over(uint64_t v);

/* Takes at most `owed`, in this unit, and at most half of what the motion has. Returns what is left of it. */
int32_t step_repay(fray_world *w, const step_motion *motion, int32_t owed, step_energy_unit unit,
                   const elastic_step *step);

#endif
