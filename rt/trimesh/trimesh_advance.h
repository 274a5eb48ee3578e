/* SPDX-License-Identifier: Apache-2.0 */
/* A crack goes on in any direction through the trimesh, and leaves stout triangles: trimesh_advance.c has the
 * way, trimesh_snap.c the vertex that moves onto it. */
#ifndef FRAY_TRIMESH_TRIMESH_ADVANCE_H
#define FRAY_TRIMESH_TRIMESH_ADVANCE_H

#include "rt/trimesh/trimesh_split.h"

typedef enum { TRIMESH_ALONG, TRIMESH_SNAPPED, TRIMESH_DIVIDED } trimesh_way;

typedef struct {
  uint32_t end;         /* vertex up to which an edge was opened */
  int end_was_boundary; /* it has met a boundary: no tip */
  trimesh_way way;
} trimesh_step;

/* Opens an edge from a vertex in the direction (du, dv) of rest coordinates, |du|, |dv| <= 2^30. The nearer
 * end of the edge ahead moves onto the path if its one-ring stays stout; else that edge is divided there, if
 * the parts are stout; else an edge beside it is taken. Cost: two one-rings, and trimesh_open_edge(). */
trimesh_result trimesh_advance(fray_world *w, uint32_t vertex, int32_t du, int32_t dv, trimesh_mark mark,
                               trimesh_step *step);

/* No angle is below 15 degrees, and the triangle is no sliver. */
int trimesh_is_stout(const trimesh *s, trimesh_point a, trimesh_point b, trimesh_point c);

/* Moves a free vertex inside of the sheet along its edge to vertex `to`, at `fraction` of the way, Q16: at
 * rest and in space. Areas of its one-ring are shared out anew, the largest triangle takes what rounding
 * leaves; its velocity is that which keeps the momentum, which rounding leaves to momentum_remainder.
 * TRIMESH_NO_PATH and nothing changed where a triangle would not be stout, or the velocity out of range. */
trimesh_result trimesh_snap(fray_world *w, uint32_t vertex, uint32_t to, uint32_t fraction);

#endif
