/* SPDX-License-Identifier: Apache-2.0 */
/* Splits, cuts and divisions of the trimesh (Karaoz 2015, sections 2.7 and 3.3): trimesh_split.c has vertex
 * splits and cuts, trimesh_refine.c the three operations that they consist of. Each happens as a whole, or
 * says why it cannot and changes nothing.
 *
 * - No vertex is left with two one-rings: where an edge is opened and an end of it is on the boundary
 * already,
 *   that end becomes two vertices, both at the old position and velocity, each with the mass of its own
 *   triangles.
 * - No sliver is made: a ray that would divide a triangle into parts below the minimal area or height
 *   follows the nearer of its ring edges instead, or the other one where that is a boundary.
 * - Attached vertices are never split: both sides stay attached. A tear ends before them.
 *
 * Predicted positions follow the positions; the derived arrays and the topology's hash are kept up to date.
 * */
#ifndef FRAY_TRIMESH_TRIMESH_SPLIT_H
#define FRAY_TRIMESH_TRIMESH_SPLIT_H

#include "rt/state/world.h"

typedef enum {
  TRIMESH_DONE = 0,
  TRIMESH_NO_PARTICLES, /* not enough spare particles */
  TRIMESH_NO_TRIANGLES, /* not enough spare triangles */
  TRIMESH_NO_PATH       /* the boundary, an attached vertex, a full ring, or a sliver is in its path */
} trimesh_result;

/* The point at `fraction` of the way from a to b, Q16, rounded. */
enum { TRIMESH_WEIGHT_ONE = 1 << 16 };
trimesh_point trimesh_point_on(trimesh_point a, trimesh_point b, uint32_t fraction);
/* The point of a triangle with these weights of corners 0 and 1, Q16; corner 2 has the rest. */
trimesh_point trimesh_point_in(const trimesh *s, uint32_t t, uint32_t weight0, uint32_t weight1);

/* From a vertex through triangle n of its ring to the edge opposite: at `fraction` of the way from the end of
 * ring edge n to that of n + 1, Q16; 0 is along ring edge n. */
typedef struct {
  uint32_t n;
  uint32_t fraction;
} trimesh_ray;

/* The ray in a direction of rest coordinates, |du|, |dv| <= 2^30. Returns 0 iff it leaves an open ring. */
int trimesh_ray_along(const trimesh *s, const trimesh_ring *ring, trimesh_point centre, int32_t du,
                      int32_t dv, trimesh_ray *ray);

/* Splits a vertex: a closed ring along two rays, an open one along the first alone. */
trimesh_result trimesh_split(fray_world *w, uint32_t vertex, const trimesh_ray *from, const trimesh_ray *to,
                         trimesh_mark mark);

/* Whether that would be done if the pools had room; and along `from` itself, or along a ring edge next to it.
 * */
typedef enum { TRIMESH_FITS_NOT = 0, TRIMESH_FITS_ALONG_EDGE, TRIMESH_FITS } trimesh_fit;
trimesh_fit trimesh_can_split(const fray_world *w, uint32_t vertex, const trimesh_ray *from,
                          const trimesh_ray *to);

/* The vertex at the end of ring edge n; an open ring has one more of them than triangles. */
static inline uint32_t trimesh_ring_end(const trimesh *s, const trimesh_ring *ring, uint32_t n) {
  FRAY_ASSERT(n <= ring->count);
  if (n == 0 || n < ring->count || ring->closed != 0) {
    const uint32_t m = n < ring->count ? n : 0;
    return s->triangle[ring->triangle[m]].v[trimesh_next(ring->corner[m])];
  }
  return s->triangle[ring->triangle[n - 1u]].v[trimesh_previous(ring->corner[n - 1u])];
}

/* Opens edge k, which has a neighbour: an end on the boundary becomes two vertices. */
trimesh_result trimesh_open_edge(fray_world *w, uint32_t t, uint32_t k, trimesh_mark mark);

/* The same for the edge between two vertices. */
trimesh_result trimesh_open_to(fray_world *w, uint32_t vertex, uint32_t end, trimesh_mark mark);

/* The ring has room for so many triangles more. */
int trimesh_ring_has_room(const trimesh *s, uint32_t vertex, uint32_t added);
/* Its area, which an image may say to be any number, is enough to divide it and then a part of it. */
static inline int trimesh_has_area(const trimesh *s, uint32_t t) { return s->area[t] >= 8; }
/* Both parts of a triangle that is divided from corner k to a point of the opposite edge exceed this quality:
 * trimesh_exceeds_quality(). */
int trimesh_parts_exceed(const trimesh *s, uint32_t by, uint32_t t, uint32_t k, trimesh_point at);
/* 1 iff no part is a sliver and no ring is full. */
int trimesh_can_divide_edge(const trimesh *s, uint32_t t, uint32_t k, uint32_t fraction);
int trimesh_can_divide_triangle(const trimesh *s, uint32_t t, uint32_t weight0, uint32_t weight1);
/* A new vertex on edge k, at `fraction` of the way from corner k + 1 to k + 2. */
trimesh_result trimesh_divide_edge(fray_world *w, uint32_t t, uint32_t k, uint32_t fraction,
                               uint32_t *added);
/* A new vertex in a triangle. */
trimesh_result trimesh_divide_triangle(fray_world *w, uint32_t t, uint32_t weight0, uint32_t weight1,
                                   uint32_t *added);

/* Marks a triangle as one that a blade may be passing, or unmarks it. */
void trimesh_set_passing_blade(fray_world *w, uint32_t t, int passing);

/* The vertices around which a cut opened the trimesh: all that became two, and the new ones; the first is at
 * the blade. */
enum { TRIMESH_CUT_VERTICES = 10 };
typedef struct {
  uint32_t count;
  uint32_t vertex[TRIMESH_CUT_VERTICES];
} trimesh_cut_vertices;

/* A sharp edge through edge k: that is divided where they met, and the trimesh opened from there to both
 * sides along (du, dv). Near an end of the edge, or where the parts would be slivers, the nearer end is split
 * instead. */
trimesh_result trimesh_cut_edge(fray_world *w, uint32_t t, uint32_t k, uint32_t fraction, int32_t du,
                            int32_t dv, trimesh_cut_vertices *cut);
/* A sharp point through a triangle: three new edges from there to its corners, all open. Near an edge,
 * that is divided and opened as by trimesh_cut_edge() along (du, dv). */
trimesh_result trimesh_cut_triangle(fray_world *w, uint32_t t, uint32_t weight0, uint32_t weight1,
                                int32_t du, int32_t dv, trimesh_cut_vertices *cut);

#endif
