/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns with a stiffness: worlds whose links pull with a force of the scene. */
#ifndef FRAY_MODEL_STRETCH_H
#define FRAY_MODEL_STRETCH_H

#include "rt/model/rows.h"

enum {
  STRETCH_STEPS_BITS = 6,       /* at most 64 inner steps in a substep */
  STRETCH_PULL_LEAST = 1 << 29, /* of mantissas */
  STRETCH_SCALE_LEAST = 8,
  STRETCH_SCALE_MOST = 56,
  STRETCH_DAMPING_MOST = 1 << 27
};

/* Of a class of links. A link d that is too long by e = |d|^2 - R^2, in its direction units, gives
 * each end d * e * phi(u) * mantissa * 2^-(scale + 24), Q28 lu per substep, in an inner step;
 * stage/stretch.c. */
typedef struct {
  int32_t pull, pull_scale; /* where it is stretched; mantissas are 0 or 30 bits */
  int32_t push, push_scale; /* where it is pressed */
  int32_t damping; /* Q24 of 2^25 / R^2 times the share of their speed apart that each end loses */
} stretch_class;

enum { STRETCH_CLASS_WORDS = sizeof(stretch_class) / 4 };

#endif
