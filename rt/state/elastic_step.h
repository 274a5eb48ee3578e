/* SPDX-License-Identifier: Apache-2.0 */
/* Data of the membrane's elastic steps, the inner steps of a substep: see membrane/membrane_step.c. */
#ifndef FRAY_STATE_ELASTIC_STEP_H
#define FRAY_STATE_ELASTIC_STEP_H

#include "rt/state/material.h"
#include "rt/state/params.h"
#include "rt/state/spring.h"

/* Of a vertex. */
typedef struct {
  int32_t at[3];    /* Q28 lu, wraps */
  int32_t low_bits; /* two bits more of each, a byte an axis */
} elastic_position;

/* Sum of impulses on a vertex, Q26. */
typedef struct {
  int32_t x, y, z, padding;
} elastic_impulse;

/* Of a watched world's vertex: the part of that sum that damps stress, and the sum behind zones, repayment,
 * lengths of edges, contact and rates of edges. */
enum { STEP_MARKS = 6 };
typedef struct {
  vec3 damping, sum[STEP_MARKS - 1];
} metered_impulse;

/* Of its body, behind the last mark: its impulse on the cloth, its speed, and what forces changed of
 * that, Q44. */
typedef struct {
  int64_t impulse[3];
  int64_t speed[3], forced[3];
} metered_body;

/* A body in the elastic steps of a substep. */
typedef struct {
  vec3 start;                    /* where the substep began, Q24 lu */
  int32_t at[3], low[3];         /* where it is: Q28 lu, wraps, and 31 bits below it */
  int32_t moved[3];              /* in this step, Q28 */
  int32_t before[3];             /* velocity before the forces of this step, Q28 lu per substep */
  int32_t half[3];               /* half of what these change of it */
  int32_t plane_gap[MAX_BODIES]; /* of a free body: height above each plane, Q28 */
} elastic_body;

enum { LIMITED_EDGES_PER_TRIANGLE = 3 }; /* room in the pool */

/* An edge near the limit of its length or of its rate, in a substep. */
typedef struct {
  index_t i, j;
  uint32_t rest; /* its length at rest, Q24 lu */
} limited_edge;

/* c of a triangle in this tick (until membrane_gains_update()), then c times its area: from a strain in Q28
 * to an impulse, see membrane/membrane_gains.c. */
typedef struct {
  int32_t c[MATERIAL_ENTRIES];
} membrane_gain;

/* Elastic steps carry 31 bits below Q28: positions rounded in each step would excite vibrations of stiff
 * triangles, a dozen times stronger than all other rounding. */
enum { ELASTIC_LOW_BITS = 31, ELASTIC_DIFFERENCE_MORE = 2, ELASTIC_DIFFERENCE_MAX = (1 << 29) - 1 };
enum { ELASTIC_IMPULSE_BITS = 26, ELASTIC_INVERSE_BITS = 24 };

static inline int32_t elastic_low_bits(int32_t low_x, int32_t low_y, int32_t low_z) {
  const unsigned s = ELASTIC_LOW_BITS - ELASTIC_DIFFERENCE_MORE;
  return fx_asr(low_x, s) | fx_asr(low_y, s) << 8 | fx_asr(low_z, s) << 16;
}
/* Q30, exact as long as they are less than 8 lu apart; beyond 2 lu it is held to 2. */
static inline int32_t elastic_difference(const elastic_position *from, const elastic_position *to,
                                         uint32_t axis) {
  const int32_t whole = fx_clamp_rare(fx_wrap_sub(to->at[axis], from->at[axis]), -ELASTIC_DIFFERENCE_MAX,
                                      ELASTIC_DIFFERENCE_MAX);
  return whole * (1 << ELASTIC_DIFFERENCE_MORE) +
         ((to->low_bits >> 8u * axis) & 3) - ((from->low_bits >> 8u * axis) & 3);
}

static inline vec3 elastic_impulse_vec(const elastic_impulse *sum) {
  return vec_make(sum->x, sum->y, sum->z);
}
static inline void elastic_impulse_add(elastic_impulse *sum, vec3 j) {
  sum->x = fx_add(sum->x, j.x);
  sum->y = fx_add(sum->y, j.y);
  sum->z = fx_add(sum->z, j.z);
}

#endif
