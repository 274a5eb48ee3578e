/* SPDX-License-Identifier: Apache-2.0 */
/* The arguments of simd_yarn_slip(). Arrays need the alignment of their elements, no more. */
#ifndef FRAY_SIMD_YARN_SLIP_VIEW_H
#define FRAY_SIMD_YARN_SLIP_VIEW_H

#include "rt/base/fx.h"

/* The particles of a crossing: its warp, its weft, and the far ends of its four springs, by direction.
 * Where a spring is missing, the far end repeats a particle of the crossing. */
enum { SLIP_WARP, SLIP_WEFT, SLIP_FAR, SLIP_ENDS = 6 };
/* Bits of facts: SLIP_LIGHT << n, far end n has half mass; SLIP_END_MISSING << n, it is missing (n = 0..3);
 * SLIP_UNDER, the warp passes under the weft. */
enum { SLIP_LIGHT = 1, SLIP_END_MISSING = 16, SLIP_UNDER = 256 };

/* Arrays by axis x, y, z have one word for each particle; crossings of a run share no particle, and none of
 * their particles is attached. */
typedef struct {
  int32_t *at[3], *predicted[3]; /* Q24 lu, within +-FX_WORLD_MAX; written */
  int32_t *speed[3];             /* Q28 lu per substep, within +-FX_SPEED_MAX; written */
  const int32_t *end[SLIP_ENDS]; /* one for each crossing: particles */
  const int32_t *facts;          /* one for each crossing */
  int32_t thickness;             /* Q24 lu, not negative */
  int32_t friction, grip;        /* Q16 of the normal correction; Q24 lu */
} yarn_slip_view;

/* Weights in Q15. To find closest points, lengths are in units of 2^SLIP_SHIFT position steps, at most
 * SLIP_MOST, as in the scalar code. */
enum { SLIP_VIEW_ONE = 1 << 15, SLIP_SHIFT = 8, SLIP_MOST = 16383 };

#endif
