/* SPDX-License-Identifier: Apache-2.0 */
/* Rigid triangle meshes, the shapes of bodies of shape FRAY_MESH. All of it is constant, one table of
 * words in the image: a head, then meshes, points, edges, faces and boxes of all meshes. The head also
 * says whether triangles of the membrane are tested against meshes and spheres; a world may have it
 * without any mesh.
 *
 * Indices of points, edges and faces count from the mesh's first. The boxes of a mesh are a tree in
 * preorder, each box around everything below it. It is walked without a stack: from a box that overlaps
 * to the one behind it, from one that does not to `next`, in at most as many steps as there are boxes. A
 * leaf has one face; faces are numbered in the order of the leaves. */
#ifndef FRAY_STATE_RIGID_MESH_H
#define FRAY_STATE_RIGID_MESH_H

#include "rt/state/world.h"

enum {
  RIGID_MESH_NONE = -1,
  RIGID_MESH_REACH_MAX = 16 * FX_LU,
  /* budgets of a particle near a mesh in a substep; see contact/contact_vertices.c */
  RIGID_MESH_VISITS = 1024, /* boxes in one walk */
  RIGID_MESH_NEAR = 64,     /* triangles tested against its path */
  RIGID_MESH_ROUNDS = 4,    /* pushes */
  COLLIDER_CHECKS = 2,     /* tests of what other bodies did, where there are several */
  /* and of a triangle of the membrane; see contact/contact_triangles.c */
  RIGID_MESH_TRIANGLES = 2,     /* of them, for each contact: a sheet has two a vertex */
  RIGID_MESH_CLOSE = 256,       /* triangles of a mesh near it */
  RIGID_MESH_CLOSE_CCD = 1024,
  RIGID_MESH_CHECKS = 4
};

typedef struct {
  int32_t meshes, points, edges, faces, boxes;
  int32_t meets_triangles; /* 1: triangles of the membrane are tested too, 0: vertices only */
} rigid_mesh_head;

typedef struct {
  int32_t body;          /* rising; every body of shape FRAY_MESH has one */
  int32_t point, points; /* the first of each and how many */
  int32_t edge, edges;
  int32_t face, faces;
  int32_t box;           /* 2 * faces - 1 */
} rigid_mesh_entry;

/* A point; sharp ones cut. */
typedef struct {
  int32_t at[3]; /* Q24 lu from the body's position, at most RIGID_MESH_REACH_MAX */
  int32_t sharp;
  int32_t face; /* the one that owns it, of those that have it */
} rigid_mesh_point;

/* Face 0 has it from point 0 to point 1, face 1 the other way; sorted by the lesser, then the other point. */
typedef struct {
  int32_t point[2];
  int32_t face[2]; /* the second is RIGID_MESH_NONE at the boundary */
  int32_t sharp;
} rigid_mesh_edge;

typedef struct {
  int32_t point[3]; /* anticlockwise from outside */
  int32_t normal[3]; /* Q30, as rigid_mesh_normal() computes it */
  int32_t owned_edges;       /* bit k: this is face 0 of its edge k, from point k on */
} rigid_mesh_face;

typedef struct {
  int32_t low[3], high[3]; /* Q24 lu from the body's position, ends included */
  int32_t next;            /* box behind all that are below this one */
  int32_t face;            /* RIGID_MESH_NONE: not a leaf */
} rigid_mesh_box;

enum {
  RIGID_MESH_HEAD_WORDS = sizeof(rigid_mesh_head) / 4,
  RIGID_MESH_WORDS = sizeof(rigid_mesh_entry) / 4,
  RIGID_MESH_POINT_WORDS = sizeof(rigid_mesh_point) / 4,
  RIGID_MESH_EDGE_WORDS = sizeof(rigid_mesh_edge) / 4,
  RIGID_MESH_FACE_WORDS = sizeof(rigid_mesh_face) / 4,
  RIGID_MESH_BOX_WORDS = sizeof(rigid_mesh_box) / 4
};

/* Views of one mesh. */
typedef struct {
  const rigid_mesh_entry *of;
  const rigid_mesh_point *points;
  const rigid_mesh_edge *edges;
  const rigid_mesh_face *faces;
  const rigid_mesh_box *boxes;
  uint32_t box_count;
} rigid_mesh_parts;

uint32_t rigid_mesh_count(const fray_world *w);
/* n below rigid_mesh_count(). */
rigid_mesh_parts rigid_mesh_at(const fray_world *w, uint32_t n);
/* Triangles of the membrane are tested against meshes and spheres. */
int rigid_mesh_meets_triangles(const fray_world *w);
/* Bodies that are tested by CCD, at most MAX_BODIES: meshes, and spheres where triangles meet them. */
uint32_t collider_count(const fray_world *w);
/* Of a membrane nothing is pushed first: the tests are what keeps it apart. */
static inline uint32_t collider_checks(const fray_world *w) {
  const uint32_t again = collider_count(w) > 1u ? (uint32_t)COLLIDER_CHECKS : 0u;
  return world_is_projected(w) ? again : 1u + COLLIDER_CHECKS;
}
/* The mesh of a body; rigid_mesh_count() where it has none. */
uint32_t rigid_mesh_of_body(const fray_world *w, uint32_t b);

static inline vec3 rigid_mesh_corner(const rigid_mesh_parts *m, uint32_t face, uint32_t k) {
  FRAY_ASSERT(face < (uint32_t)m->of->faces && k < 3);
  return vec_of(m->points[m->faces[face].point[k]].at);
}

/* The unit normal of a triangle, Q30, error below 2^-27; 0 where it has no area. Corners within
 * RIGID_MESH_REACH_MAX. */
vec3 rigid_mesh_normal(vec3 a, vec3 b, vec3 c);

/* Mesh n has a sharp point or edge. Linear in its points and edges. */
int rigid_mesh_is_sharp(const fray_world *w, uint32_t n);
/* Edge k of a face, from its point k on, is sharp. Cost: a binary search of the edges, at most 32 steps. */
int rigid_mesh_edge_is_sharp(const rigid_mesh_parts *m, const rigid_mesh_face *face, uint32_t k);

/* Extent of the mesh from the body's position along a unit vector, Q24 lu. Linear in its points. */
int32_t rigid_mesh_extent(const rigid_mesh_parts *m, vec3 along);

/* NULL, or what was expected and is not so: indices in range, edges that join the faces of a manifold,
 * normals of their faces, a tree of boxes around everything. Linear in the words. */
const char *rigid_mesh_error(const fray_world *w);

#endif
