/* SPDX-License-Identifier: Apache-2.0 */
/* Rectangles in triangles, in integers. */
#ifndef FRAY_BUILD_MESH_H
#define FRAY_BUILD_MESH_H

#include "tools/build/draft.h"

/* A column or row of a vertex that is on no line of the grid. */
enum { MESH_INSIDE = 1 };

typedef struct {
  uint32_t points, triangles;
  int32_t *s, *t;          /* of a point, Q24 lu: to the right, and up, from the lower left corner */
  uint32_t *column, *row;  /* of a point: 0 left and top; MESH_INSIDE where the mesh is not regular */
  uint32_t (*corner)[3];   /* of a triangle: points, anticlockwise in s and t */
} mesh;

/* The scene's; d->spacing is set. Returns 0 with the error filled. */
int mesh_make(draft *d, mesh *m);
void mesh_free(mesh *m);

/* Triangulates all points so that no point lies inside of a triangle's circle (Delaunay), in a square of
 * `extent`, deterministically. Fills m->triangles and m->corner. Returns 0 iff memory ran out or points
 * fall together. */
int mesh_triangulate(mesh *m);

#endif
