/* SPDX-License-Identifier: Apache-2.0 */
/* Continuous collision detection (CCD): the first time in a step at which two edges, or a point and a
 * triangle, come within a thickness of each other. Every point moves on a straight line, at its own speed.
 *
 * A contact: there is a t in [0, 1] at which the distance is at most `thickness`. With thickness 0
 * that is touching, at t = 0 and t = 1 too, of parallel edges, in a plane, of edges and triangles
 * without length or area. No contact is missed. A false alarm is a pair that
 * came near: nearly all to less than 2^-12 of the extent of the pair and its motion. Those farther apart
 * used up the bound of the work; tests/physics/test_ccd_exact.c counts both.
 *
 * Sources: Metaaphanon 2009, section 4.2, equation 5; Karaoz 2015, section 2.6, equations 2.65 to
 * 2.68, where 2.68 lacks the offset AC: C + v CD - A - u AB = 0. */
#ifndef FRAY_GEOMETRY_CCD_H
#define FRAY_GEOMETRY_CCD_H

#include "rt/base/vec.h"

enum { CCD_ONE = 1 << 15 };

/* Where a point is at t = 0 and at t = 1: Q24 lu, at most FX_WORLD_MAX. */
typedef vec_path ccd_path;

typedef struct {
  int32_t time;      /* Q15, 0..CCD_ONE; never later than the first contact */
  int32_t weight[2]; /* Q15, 0..CCD_ONE, the closest points then: positions along the first and the second
                    edge, or the weights of the triangle's second and third corner */
  vec3 normal; /* Q30, length 1 within 2^-27, from the first to the second; where the distance is 0 then, on
                  the side of t = 0; where that is 0 too, (0, 1, 0) */
} ccd_contact;

/* Returns 1 and the contact, or 0 (*contact is then undefined). 0 <= thickness <= FX_WORLD_MAX.
 * Cost in instructions of a Cortex-M3: edges of cloth near each other that do not meet 300 on
 * average; a contact 2,000 to 4,700 on average; any call at most 9,300 (tests/wcet/ccd.sh). */
int ccd_edges(const ccd_path first[2], const ccd_path second[2], int32_t thickness, ccd_contact *contact);
int ccd_point_triangle(const ccd_path *point, const ccd_path triangle[3], int32_t thickness,
                       ccd_contact *contact);

/* Lower bounds of the distance at t = 0 (nearly exact) and at t = 1, along the direction between the
 * closest points at t = 0; in between the distance is at least the smaller one. Q24 lu, 0 if unknown. Cost:
 * a sixth of a contact. */
typedef struct {
  int32_t begin, end;
} ccd_gap;
ccd_gap ccd_gap_edges(const ccd_path first[2], const ccd_path second[2]);
ccd_gap ccd_gap_point_triangle(const ccd_path *point, const ccd_path triangle[3]);

#endif
