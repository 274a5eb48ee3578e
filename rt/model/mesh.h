/* SPDX-License-Identifier: Apache-2.0 */
/* Rigid triangle meshes: the shapes of bodies of shape FRAY_MESH. All of it is constant, one table of
 * words in the image: a head, then meshes, points, edges, faces and boxes of all meshes. The head says
 * too whether triangles of a sheet are held against meshes and balls; a world may have it without meshes.
 *
 * Numbers of points, edges and faces count from the mesh's first. The boxes of a mesh are a tree, each
 * one around what stands under it, a box in front of its children: without a stack one goes from a box
 * that is met to the one behind it, from one that is not to `next`, in as many steps as there are boxes
 * at most. A leaf has one face; faces are numbered in the order of the leaves. */
#ifndef FRAY_MODEL_MESH_H
#define FRAY_MODEL_MESH_H

#include "rt/model/world.h"

enum {
  MESH_NONE = -1,
  MESH_REACH_MAX = 16 * FX_LU,
  /* bounds of the work that a particle near a mesh makes in a substep; see stage/meshes.c */
  MESH_VISITS = 1024, /* boxes in one walk */
  MESH_NEAR = 64,     /* triangles held against its way */
  MESH_ROUNDS = 4,    /* pushes */
  MESH_LOOKS = 2,     /* where there are several bodies: at what each of them did */
  /* and a triangle of a sheet; see stage/press.c */
  MESH_CLOSE = 256,       /* triangles of a mesh beside it */
  MESH_CLOSE_SWEEPS = 1024,
  MESH_PRESSES = 2,
  MESH_CHECKS = 4
};

typedef struct {
  int32_t meshes, points, edges, faces, boxes;
  int32_t whole; /* 1: triangles of the sheet meet meshes and balls, 0: only its vertices do */
} mesh_head;

typedef struct {
  int32_t body;          /* rising; every body of shape FRAY_MESH has one */
  int32_t point, points; /* the first of each and how many */
  int32_t edge, edges;
  int32_t face, faces;
  int32_t box;           /* 2 * faces - 1 */
} mesh_entry;

/* Sharp points and edges cut. */
typedef struct {
  int32_t at[3]; /* Q24 lu from the body's position, at most MESH_REACH_MAX */
  int32_t sharp;
  int32_t face; /* one of those that have it */
} mesh_point;

/* Face 0 passes it from point 0 to point 1, face 1 back; sorted by the lesser, then the other point. */
typedef struct {
  int32_t point[2];
  int32_t face[2]; /* the second is MESH_NONE at a border */
  int32_t sharp;
} mesh_edge;

typedef struct {
  int32_t point[3]; /* anticlockwise from outside */
  int32_t normal[3]; /* Q30, what mesh_normal() says */
  int32_t own;       /* bit k: side k, from point k on, is an edge of which this is face 0 */
} mesh_face;

typedef struct {
  int32_t low[3], high[3]; /* Q24 lu from the body's position, ends included */
  int32_t next;            /* of the boxes of the mesh: behind all that stands under this one */
  int32_t face;            /* MESH_NONE: not a leaf */
} mesh_box;

enum {
  MESH_HEAD_WORDS = sizeof(mesh_head) / 4,
  MESH_WORDS = sizeof(mesh_entry) / 4,
  MESH_POINT_WORDS = sizeof(mesh_point) / 4,
  MESH_EDGE_WORDS = sizeof(mesh_edge) / 4,
  MESH_FACE_WORDS = sizeof(mesh_face) / 4,
  MESH_BOX_WORDS = sizeof(mesh_box) / 4
};

/* One mesh and where its parts stand. */
typedef struct {
  const mesh_entry *of;
  const mesh_point *points;
  const mesh_edge *edges;
  const mesh_face *faces;
  const mesh_box *boxes;
  uint32_t box_count;
} mesh_parts;

uint32_t mesh_count(const fray_world *w);
/* n below mesh_count(). */
mesh_parts mesh_at(const fray_world *w, uint32_t n);
/* Triangles of the sheet meet meshes and balls. */
int mesh_is_whole(const fray_world *w);
/* Bodies that particles and triangles are held against as they go, at most LIMIT_BODIES: meshes, and balls
 * where triangles meet them. */
uint32_t mesh_solids(const fray_world *w);
static inline uint32_t mesh_looks(const fray_world *w) {
  return mesh_solids(w) > 1u ? (uint32_t)MESH_LOOKS : 0u;
}
/* The mesh of a body; mesh_count() where it has none. */
uint32_t mesh_of_body(const fray_world *w, uint32_t b);

static inline vec3 mesh_vec(const int32_t v[3]) { return vec_make(v[0], v[1], v[2]); }
static inline vec3 mesh_corner(const mesh_parts *m, uint32_t face, uint32_t k) {
  return mesh_vec(m->points[m->faces[face].point[k]].at);
}

/* The unit normal of a triangle, Q30, off by less than 2^-27; 0 where it has no area. Corners within
 * MESH_REACH_MAX. */
vec3 mesh_normal(vec3 a, vec3 b, vec3 c);

/* It has a sharp point or edge. Linear in its points and edges. */
int mesh_is_sharp(const fray_world *w, uint32_t n);
/* Side k of a face, from its point k on, is a sharp edge. Cost: a search among the edges, 32 steps at most. */
int mesh_side_is_sharp(const mesh_parts *m, const mesh_face *face, uint32_t k);

/* How far the mesh goes from the body's position along a unit vector, Q24 lu. Linear in its points. */
int32_t mesh_extent(const mesh_parts *m, vec3 along);

/* NULL, or what is wrong with the tables: every number in its range, edges that join the faces of a
 * manifold, normals that follow, a tree of boxes around all of it. Linear in the words. */
const char *mesh_wrong(const fray_world *w);

#endif
