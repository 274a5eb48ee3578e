/* SPDX-License-Identifier: Apache-2.0 */
/* Strength of a material of the membrane: the tension per length at which it tears (Karaoz 2015, sections 3.1
 * to 3.3); see membrane/separation.h. */
#ifndef FRAY_STATE_TEAR_STRENGTH_H
#define FRAY_STATE_TEAR_STRENGTH_H

#include <stdint.h>

enum { TEAR_STRENGTH_DIRECTIONS = 4, MAX_TEAR_STRENGTH = 1 << 25, MAX_TEAR_COOLDOWN = 1 << 20 };

/* Of a material.
 *    name              min         max */
#define TEAR_STRENGTHS(X) \
  X(strength_0,         0,          MAX_TEAR_STRENGTH) /* Q12 N/m across a tear along the warp; 0 in all */ \
  X(strength_45,        0,          MAX_TEAR_STRENGTH) /* directions: it never tears */ \
  X(strength_90,        0,          MAX_TEAR_STRENGTH) /* along the weft */ \
  X(strength_135,       0,          MAX_TEAR_STRENGTH) \
  X(cooldown,           0,          MAX_TEAR_COOLDOWN)    /* ticks without a tear that follow a tear */
typedef struct {
  int32_t strength[TEAR_STRENGTH_DIRECTIONS];
  int32_t cooldown;
} tear_strength;
enum { TEAR_STRENGTH_WORDS = sizeof(tear_strength) / 4 };

/* The smallest strength in any direction; 0: it never tears. */
static inline int32_t tear_strength_min(const tear_strength *t) {
  int32_t min = t->strength[0];
  for (uint32_t n = 1; n < TEAR_STRENGTH_DIRECTIONS; ++n)
    if (t->strength[n] < min) min = t->strength[n];
  return min;
}

#endif
