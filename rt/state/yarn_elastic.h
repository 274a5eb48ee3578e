/* SPDX-License-Identifier: Apache-2.0 */
/* Constants of elastic yarns: their links have the stiffness of the scene, in newtons
 * (woven/yarn_stretch.c). */
#ifndef FRAY_STATE_YARN_ELASTIC_H
#define FRAY_STATE_YARN_ELASTIC_H

#include "rt/state/spring.h"

enum {
  YARN_ELASTIC_STEPS_BITS = 6,       /* at most 64 elastic steps in a substep */
  YARN_ELASTIC_PULL_MIN = 1 << 29, /* of mantissas */
  YARN_ELASTIC_SCALE_MIN = 8,
  YARN_ELASTIC_SCALE_MAX = 56,
  YARN_ELASTIC_DAMPING_MAX = 1 << 27,
  /* Q28 lu per substep, of one link along an axis in an elastic step: four ends of whole mass or two of half,
   * twice, fit */
  YARN_ELASTIC_IMPULSE_MAX = 1 << 27
};

/* Gains of a class of links. A link d that is too long by e = |d|^2 - R^2, in its direction units, changes
 * the velocity of each end by d * e * phi(u) * mantissa * 2^-(scale + 24), Q28 lu per substep, in an
 * elastic step. */
typedef struct {
  int32_t pull, pull_scale; /* of a stretched link; mantissas are 0 or have 30 bits */
  int32_t push, push_scale; /* of a compressed link */
  int32_t damping; /* Q24 of 2^25 / R^2 times the fraction of their separating speed that each end loses */
} yarn_gain;

enum { YARN_GAIN_WORDS = sizeof(yarn_gain) / 4 };

/* Marks of an elastic step, for the energy ledger: before it, behind its damping, behind all but contact. */
typedef enum { YARN_STEP_BEGUN, YARN_STEP_DAMPED, YARN_STEP_FORCED, YARN_STEP_MARKS } yarn_step_mark;

/* Of a watched world: velocities behind these marks, Q28 lu per substep. */
typedef struct {
  vec3 velocity[YARN_STEP_MARKS];
} metered_yarn;
/* Of a body: its impulse on the cloth and its speed, Q44. */
typedef struct {
  int64_t impulse[3], speed[3];
} metered_yarn_body;

#endif
