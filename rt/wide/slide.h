/* SPDX-License-Identifier: Apache-2.0 */
/* Loose couples that slip: what kernels take (slides.h); stage/slip.c says what is computed. */
#ifndef FRAY_WIDE_SLIDE_H
#define FRAY_WIDE_SLIDE_H

#include "rt/base/fx.h"

/* A couple's particles: its warp, its weft, and the far ends of its springs, by way; where there is no
 * spring, one of its own. */
enum { SLIDE_WARP, SLIDE_WEFT, SLIDE_FAR, SLIDE_ENDS = 6 };
/* Facts of a couple: which far ends are light, which are not there, whether the warp is under the weft. */
enum { SLIDE_LIGHT = 1, SLIDE_NONE = 16, SLIDE_UNDER = 256 };

/* Particles by axis: where they are, where they were predicted, their speeds. Couples share no particle;
 * none of their ends is held. */
typedef struct {
  int32_t *at[3], *predicted[3], *speed[3];
  const int32_t *end[SLIDE_ENDS], *facts; /* by couple */
  int32_t thickness, friction, grip;
} slide_view;

/* Q15; as in the scalar code, lengths are in units of 2^SLIDE_SHIFT steps to find the closest points. */
enum { SLIDE_ONE = 1 << 15, SLIDE_SHIFT = 8, SLIDE_MOST = 16383 };

#endif
