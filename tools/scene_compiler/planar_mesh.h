/* SPDX-License-Identifier: Apache-2.0 */
/* Triangulated rectangles, in integers. */
#ifndef FRAY_TOOLS_SCENE_COMPILER_PLANAR_MESH_H
#define FRAY_TOOLS_SCENE_COMPILER_PLANAR_MESH_H

#include "tools/scene_compiler/draft.h"

/* A column or row of a vertex that is on no line of the grid. */
enum { PLANAR_MESH_INSIDE = 1 };

typedef struct {
  uint32_t points, triangles;
  int32_t *s, *t;          /* of a point, Q24 lu: to the right, and up, from the lower left corner */
  uint32_t *column,
      *row; /* of a point: 0 left and top; PLANAR_MESH_INSIDE in patterns that are not regular */
  uint32_t (*corner)[3];   /* of a triangle: points, anticlockwise in s and t */
} planar_mesh;

/* The scene's; d->spacing is set. Returns 0 with the error filled. */
int planar_mesh_make(draft *d, planar_mesh *m);
void planar_mesh_free(planar_mesh *m);

/* Delaunay triangulation of all points, in a square of `extent`, deterministic. Fills m->triangles and
 * m->corner. Returns 0 iff memory ran out or two points coincide. */
int delaunay_triangulate(planar_mesh *m);

#endif
