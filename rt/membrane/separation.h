/* SPDX-License-Identifier: Apache-2.0 */
/* Separation strength: how strongly the triangles of a one-ring pull its vertex apart along a line (Karaoz
 * 2015, sections 2.7, 3.1 and 3.2). Functions of numbers alone.
 *
 * All directions are those of the rest coordinates, u along weft and v along warp. The traction of a
 * part of the ring is the integral of stress times direction over the directions in it; with a stress
 * that is constant in a triangle that is the sum of (2.69), in which t is the direction of an edge turned
 * by a right angle. Only the positive part of a stress counts.
 *
 * A line goes through a closed ring to both sides of the vertex, and ends in the vertex of an open one,
 * where it divides the rest of the ring:
 *
 *   q1, q2     tractions of the parts to the left and to the right of it
 *   q          the unit vector of q1 - q2
 *   separation min(q1 . q, -q2 . q), or 0: as (2.71) is meant; as printed it is negative under a balanced
 *              load
 *
 * A tension of 1 N/m across the line is a separation of 2 N/m in a closed ring and of 1 N/m in an open
 * one: the length that tears within a circle of radius 1. A required strength is per length, so it counts
 * twice in a closed ring, and the boundary is as strong as the interior.
 *
 *   stress, strength   Q12 N/m, or any other one format
 *   directions         Q30 */
#ifndef FRAY_MEMBRANE_SEPARATION_H
#define FRAY_MEMBRANE_SEPARATION_H

#include "rt/base/sym2.h"
#include "rt/state/trimesh.h"

/* Entries of a stress are held to this. */
#define SEPARATION_STRESS_MAX ((int32_t)1 << 26)

typedef struct {
  int32_t u, v;
} separation_direction;

/* Closed: edge[count] is edge[0]. */
typedef struct {
  uint32_t count, closed;
  int32_t major;                                 /* the largest principal stress, or 0 */
  separation_direction edge[TRIMESH_RING_MAX + 1]; /* ring edges: triangle n is between edge n and n + 1 */
  separation_direction middle[TRIMESH_RING_MAX];   /* from the vertex to the middle of the opposite edge */
  sym2 stress[TRIMESH_RING_MAX];                   /* positive parts */
  int64_t traction_u[TRIMESH_RING_MAX + 1];      /* of triangles 0 to n - 1 together, Q30 of the stress */
  int64_t traction_v[TRIMESH_RING_MAX + 1];
} separation_ring;

/* Takes count, closed, in `edge` the ends of the ring edges relative to the vertex, and in `stress` the
 * stresses of the triangles between them; computes the rest. */
void separation_prepare(separation_ring *ring);

/* A triangle has three candidates, and shares two with its neighbours: along both its ring edges, and to
 * the middle of the third edge. Number 2 n is along edge n, 2 n + 1 through the middle of triangle n.
 * The boundary edges of an open ring are none: it has those from 1 to 2 count - 1. */
static inline uint32_t separation_first(const separation_ring *ring) { return ring->closed != 0 ? 0 : 1; }
static inline uint32_t separation_end(const separation_ring *ring) { return 2u * ring->count; }

/* The material requires a strength of a line by its direction (3.1 to 3.3): given are those at 0, 45, 90,
 * 135 degrees, in between it is linear in the angle. 0 is along the warp; 45 between warp and weft, both
 * positive; 90 along the weft. */
enum { SEPARATION_STRENGTHS = 4 };

/* A candidate with the required strength, for the whole length that tears. */
typedef struct {
  int32_t separation; /* stress times length */
  int32_t required;
  uint32_t candidate;
  uint32_t opposite; /* of a closed ring: the triangle on the other side of the vertex */
  separation_direction line;
} separation_ratio;
separation_ratio separation_ratio_of(const separation_ring *ring, uint32_t candidate,
                                     const int32_t strength[SEPARATION_STRENGTHS]);
/* omega of a is above that of b (3.4), exactly; required is above 0. */
static inline int separation_exceeds(const separation_ratio *a, const separation_ratio *b) {
  return fx_mul_wide(a->separation, b->required) > fx_mul_wide(b->separation, a->required);
}

/* No candidate's separation is above this, per length that tears; major is the largest principal
 * stress in the ring. */
static inline int64_t separation_bound(int32_t major, int closed) {
  return (closed ? (int64_t)2 : (int64_t)4) * major;
}

#endif
