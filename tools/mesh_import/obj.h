/* SPDX-License-Identifier: Apache-2.0 */
/* Triangle meshes from OBJ files: points in exact decimals, faces as triangles, and how they join.
 *
 *   v x y z            a point, in units of the file; a fourth number must be 1, six numbers are a
 *                      point and its colour, which is skipped
 *   f a b c ...        a face by its corners, anticlockwise as seen from outside; a/t/n: t and n are
 *                      skipped; below 0: counted back from the latest point
 *   l a b ..., p a ... edges and points that are marked (of rigid meshes: sharp)
 *   vt vn vp o g s mg usemtl mtllib and comments are skipped, anything else is refused
 *
 * A face of more than three corners becomes a fan around its first: 1 2 3, 1 3 4, ... A line that ends
 * in \ continues in the next. */
#ifndef FRAY_TOOLS_MESH_IMPORT_OBJ_H
#define FRAY_TOOLS_MESH_IMPORT_OBJ_H

#include "tools/scene_language/scene.h"

enum {
  OBJ_BYTES_MAX = 1 << 26,
  OBJ_POINTS_MAX = 1 << 18,
  OBJ_TRIANGLES_MAX = 1 << 19,
  OBJ_MARKS_MAX = 1 << 19,
  OBJ_CORNERS_MAX = 64 /* of a face */
};
#define OBJ_NONE UINT32_MAX

typedef struct {
  exact at[3];
  int line;
} obj_point;

typedef struct {
  uint32_t point[3];
  uint32_t face; /* of the file, from 0 */
  int line;
} obj_triangle;

/* An edge, or a point twice. */
typedef struct {
  uint32_t point[2];
  int line;
} obj_mark;

/* The first triangle passes it from the first point to the second, the second triangle, if there is one,
 * back. Sorted by the lower, then the higher point. */
typedef struct {
  uint32_t point[2];
  uint32_t triangle[2]; /* OBJ_NONE at a border */
} obj_edge;

typedef struct {
  obj_point *points;
  obj_triangle *triangles;
  obj_mark *marks;
  obj_edge *edges;
  uint32_t point_count, triangle_count, mark_count, edge_count, face_count;
} obj_mesh;

/* Reads the text and checks that it is a manifold: every point is in a
 * triangle, all triangles of a point are one fan around it, an edge has one or two triangles, and two
 * pass it in opposite directions. Returns 1, or 0 with *error filled; obj_free() in both cases. */
int obj_read(const char *file, const char *text, size_t bytes, obj_mesh *mesh, scene_error *error);
/* The same of a regular file. */
int obj_load(const char *file, obj_mesh *mesh, scene_error *error);
void obj_free(obj_mesh *mesh);

/* The edge between two points, either way round; OBJ_NONE where there is none. */
uint32_t obj_edge_between(const obj_mesh *mesh, uint32_t a, uint32_t b);

/* Joins triangles to edges and checks that; a part of obj_read(). */
int obj_join(const char *file, obj_mesh *mesh, scene_error *error);

/* Always 0: fills the error. */
int obj_refuse(scene_error *error, const char *file, int line, int column, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

#endif
