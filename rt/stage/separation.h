/* SPDX-License-Identifier: Apache-2.0 */
/* How strongly the triangles around a vertex pull it apart along a line (Karaoz 2015, sections 2.7, 3.1
 * and 3.2), as functions of numbers alone.
 *
 * All directions are those of the rest coordinates, u along weft and v along warp. The traction of a
 * part of the fan is the integral of stress times direction over the directions in it; with a stress
 * that is constant in a triangle that is the sum of (2.69), in which t is the direction of a side turned
 * by a right angle. Only the positive part of a stress pulls.
 *
 * A line goes through a closed fan to both sides of the vertex, and ends in the vertex of an open one,
 * where it divides what is left of the fan:
 *
 *   q1, q2     tractions of what lies to the left and to the right of it
 *   q          the unit vector of q1 - q2
 *   separation min(q1 . q, -q2 . q), or 0: as (2.71) is meant; as printed it is negative under a balanced
 *              load
 *
 * A tension of 1 N/m across the line is a separation of 2 N/m in a closed fan and of 1 N/m in an open
 * one: as much as what tears, within a circle of radius 1, is long. A required strength is per length,
 * so it counts twice in a closed fan, and a sheet is as strong at its border as inside.
 *
 *   stress, strength   Q12 N/m, or any other one format
 *   directions         Q30 */
#ifndef FRAY_STAGE_SEPARATION_H
#define FRAY_STAGE_SEPARATION_H

#include "rt/base/sym2.h"
#include "rt/model/sheet.h"

/* Entries of a stress; what is more is cut to it. */
#define SEPARATION_STRESS_MAX ((int32_t)1 << 26)

typedef struct {
  int32_t u, v;
} direction;

/* Closed: spoke[count] is spoke[0]. */
typedef struct {
  uint32_t count, closed;
  int32_t major; /* the largest principal stress, or 0 */
  direction spoke[SHEET_FAN + 1];
  direction middle[SHEET_FAN];
  sym2 pull[SHEET_FAN]; /* positive parts */
  /* of the traction of triangles 0 to n - 1, in Q30 of the stress */
  int64_t before_u[SHEET_FAN + 1], before_v[SHEET_FAN + 1];
} separation_fan;

/* Given count, closed, in `spoke` where the spokes end, seen from the vertex, and in `pull` the stresses
 * of the triangles between them. */
void separation_prepare(separation_fan *f);

/* Three candidates in a triangle, which it shares with those beside it: along both its sides, and to
 * the middle of the third one. Number 2 n is along spoke n, 2 n + 1 through the middle of triangle n.
 * The borders of an open fan are none: it has those from 1 to 2 count - 1. */
static inline uint32_t separation_first(const separation_fan *f) { return f->closed != 0 ? 0 : 1; }
static inline uint32_t separation_end(const separation_fan *f) { return 2u * f->count; }

/* The material requires a strength of a line by its direction (3.1 to 3.3): given are those at 0, 45, 90,
 * 135 degrees, in between it is linear in the angle. 0 is along the warp; 45 between warp and weft, both
 * positive; 90 along the weft. */
enum { SEPARATION_STRENGTHS = 4 };

/* A candidate with what is required of it, for all of what tears. */
typedef struct {
  int32_t separation; /* stress times length */
  int32_t required;
  uint32_t candidate;
  uint32_t opposite; /* of a closed fan: the triangle on the other side of the vertex */
  direction line;
} separation_ratio;
separation_ratio separation_ratio_of(const separation_fan *f, uint32_t candidate,
                                     const int32_t strength[SEPARATION_STRENGTHS]);
/* omega of a is above that of b (3.4), exactly; required is above 0. */
static inline int separation_exceeds(const separation_ratio *a, const separation_ratio *b) {
  return fx_mul_wide(a->separation, b->required) > fx_mul_wide(b->separation, a->required);
}

/* No candidate's separation is above this, per length of what tears; major is the largest principal
 * stress in the fan. */
static inline int64_t separation_bound(int32_t major, int closed) {
  return (closed ? (int64_t)2 : (int64_t)4) * major;
}

#endif
