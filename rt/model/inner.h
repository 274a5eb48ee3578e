/* SPDX-License-Identifier: Apache-2.0 */
/* What the inner steps of a triangle sheet work on: see stage/inner.c. */
#ifndef FRAY_MODEL_INNER_H
#define FRAY_MODEL_INNER_H

#include "rt/model/fabric.h"

/* A vertex. */
typedef struct {
  int32_t at[3]; /* Q28 lu, wraps */
  int32_t below; /* two bits more of each, a byte an axis */
} inner_place;

/* An impulse on a vertex, Q26. */
typedef struct {
  int32_t x, y, z, none;
} inner_sum;

/* c of a triangle in this tick, times its area: strain Q28 to impulse, see stage/pull.c. */
typedef struct {
  int32_t c[FABRIC_ENTRIES];
} pull_row;

/* Inner steps carry 31 bits below Q28: where positions of triangles are rounded in each, it sounds in the
 * stress of stiff sheets, a dozen times louder than all other rounding. */
enum { INNER_LOW_BITS = 31, INNER_WAY_MORE = 2, INNER_WAY_REACH = (1 << 29) - 1 };
enum { INNER_PULL_BITS = 26, INNER_INVERSE_BITS = 24 };

static inline int32_t inner_below(int32_t low_x, int32_t low_y, int32_t low_z) {
  const unsigned s = INNER_LOW_BITS - INNER_WAY_MORE;
  return fx_asr(low_x, s) | fx_asr(low_y, s) << 8 | fx_asr(low_z, s) << 16;
}
/* Q30, right as long as they are less than 8 lu apart; farther than 2 they count as 2. */
static inline int32_t inner_way(const inner_place *from, const inner_place *to, uint32_t axis) {
  const int32_t whole =
      fx_clamp_rare(fx_wrap_sub(to->at[axis], from->at[axis]), -INNER_WAY_REACH, INNER_WAY_REACH);
  return whole * (1 << INNER_WAY_MORE) +
         ((to->below >> 8u * axis) & 3) - ((from->below >> 8u * axis) & 3);
}

#endif
