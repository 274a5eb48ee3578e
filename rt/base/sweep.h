/* SPDX-License-Identifier: Apache-2.0 */
/* Continuous collisions: the first time in a step at which two edges, or a point and a triangle,
 * come within a thickness of each other. Every point moves on a straight line, at its own speed.
 *
 * A contact: there is a t in [0, 1] at which the distance is at most `thickness`. With thickness 0
 * that is touching, at t = 0 and t = 1 too, of parallel edges, in a plane, of edges and triangles
 * without length or area. No contact is missed. What is reported and is none, a false alarm, has
 * come near: nearly all to less than 2^-12 of the extent of the pair and its motion. Farther off
 * are pairs for which the bound of the work was not enough; tests/oracle/test_sweep.c counts both.
 *
 * Sources: Metaaphanon 2009, section 4.2, equation 5; Karaoz 2015, section 2.6, equations 2.65 to
 * 2.68, where 2.68 lacks the offset AC: C + v CD - A - u AB = 0. */
#ifndef FRAY_BASE_SWEEP_H
#define FRAY_BASE_SWEEP_H

#include "rt/base/vec.h"

enum { SWEEP_ONE = 1 << 15 };

/* Where a point is at t = 0 and at t = 1: Q24 lu, at most FX_WORLD_MAX. */
typedef struct {
  vec3 begin, end;
} sweep_point;

typedef struct {
  int32_t time;  /* Q15, 0..SWEEP_ONE; never later than the first contact */
  int32_t at[2]; /* Q15, 0..SWEEP_ONE, the nearest points at that time: how far along the first and
                    the second edge; weights of the triangle's second and third corner */
  vec3 normal;   /* Q30, length 1 within 2^-27, from the first to the second; where they touch at
                    that time it points as it did at t = 0, where nothing says how, (0, 1, 0) */
} sweep_contact;

/* Returns 1 and the contact, or 0 (*contact is then undefined). 0 <= thickness <= FX_WORLD_MAX.
 * Cost in instructions of a Cortex-M3: edges of cloth near each other that do not meet 300 on
 * average; a contact 2,000 to 4,700 on average; any call at most 9,300 (tests/work/sweep.sh). */
int sweep_edges(const sweep_point first[2], const sweep_point second[2], int32_t thickness,
                sweep_contact *contact);
int sweep_point_triangle(const sweep_point *point, const sweep_point triangle[3], int32_t thickness,
                         sweep_contact *contact);

/* How far apart they are, at least, along the way between the two where they are nearest at t = 0: then, which is
 * nearly all of their distance, and at t = 1. In between it is no less than the lesser one. Q24 lu, 0 where it is
 * not known. Cost: a sixth of a contact. */
typedef struct {
  int32_t begin, end;
} sweep_gap;
sweep_gap sweep_gap_edges(const sweep_point first[2], const sweep_point second[2]);
sweep_gap sweep_gap_point_triangle(const sweep_point *point, const sweep_point triangle[3]);

#endif
