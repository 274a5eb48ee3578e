/* SPDX-License-Identifier: Apache-2.0 */
/* What a cloth of a triangle sheet stands before it tears or is cut (Karaoz 2015, sections 3.1 to 3.3). */
#ifndef FRAY_MODEL_TOUGHNESS_H
#define FRAY_MODEL_TOUGHNESS_H

#include <stdint.h>

enum { TOUGHNESS_DIRECTIONS = 4, LIMIT_STRENGTH = 1 << 25, LIMIT_RELAX = 1 << 20 };

/* Of a cloth.
 *    name              least       most */
#define TOUGHNESS(X) \
  X(strength_0,         0,          LIMIT_STRENGTH) /* Q12 N/m across a tear along the warp; 0 in all */ \
  X(strength_45,        0,          LIMIT_STRENGTH) /* directions: it never tears */ \
  X(strength_90,        0,          LIMIT_STRENGTH) /* along the weft */ \
  X(strength_135,       0,          LIMIT_STRENGTH) \
  X(relax,              0,          LIMIT_RELAX)    /* ticks without a tear that follow a tear */
typedef struct {
  int32_t strength[TOUGHNESS_DIRECTIONS];
  int32_t relax;
} toughness;
enum { TOUGHNESS_WORDS = sizeof(toughness) / 4 };

/* The least strength in any direction; 0: it never tears. */
static inline int32_t toughness_least(const toughness *t) {
  int32_t least = t->strength[0];
  for (uint32_t n = 1; n < TOUGHNESS_DIRECTIONS; ++n)
    if (t->strength[n] < least) least = t->strength[n];
  return least;
}

#endif
