/* SPDX-License-Identifier: Apache-2.0 */
/* Query of one triangle of the membrane on its way past a collider: which points and edges of a rigid
 * mesh are near it, and CCD against them within a budget. */
#ifndef FRAY_CONTACT_COLLIDER_TRIANGLE_H
#define FRAY_CONTACT_COLLIDER_TRIANGLE_H

#include "rt/contact/collider.h"

typedef struct {
  ccd_path path[3];      /* of its corners, relative to the body */
  uint32_t own_edges;    /* bit k: the edge from corner k on is tested with this triangle */
  uint32_t ccd_left;     /* budget of CCD tests */
  int32_t skin;          /* distance of CCD tests */
  collider_box span;     /* around the paths */
  collider_near near;    /* triangles of the mesh with boxes that overlap it */
} collider_triangle_query;

/* Given paths, own edges and skin: fills the rest, with a span `margin` wider than the paths. Returns 0,
 * and sets a fault, where a path is out of range; sets a fault where more of the mesh is near than is
 * listed. */
int collider_triangle_begin(fray_world *w, const collider *t, int32_t margin, collider_triangle_query *q);

/* Takes one CCD test from the budget; 0, and a fault, where it is used up. */
static inline int collider_triangle_take_ccd(fray_world *w, collider_triangle_query *q) {
  if (q->ccd_left == 0) {
    world_fault(w, FRAY_FAULT_MESH_QUERY_BUDGET);
    return 0;
  }
  --q->ccd_left;
  ++w->work.mesh_ccd;
  return 1;
}

/* Weights of the corners, Q15, where a point met the triangle; where edge k was met at `along`. */
static inline void collider_triangle_weights(const ccd_contact *c, int32_t weight[3]) {
  weight[0] = fx_max(0, CCD_ONE - c->weight[0] - c->weight[1]);
  weight[1] = c->weight[0];
  weight[2] = c->weight[1];
}
static inline void collider_triangle_edge_weights(uint32_t k, int32_t along, int32_t weight[3]) {
  FRAY_ASSERT(k < 3 && along >= 0 && along <= CCD_ONE);
  weight[0] = weight[1] = weight[2] = 0;
  weight[k] = CCD_ONE - along;
  weight[trimesh_next(k)] = along;
}

/* The weighted sum of three vectors, rounded once. */
static inline vec3 collider_weighted(const int32_t weight[3], vec3 a, vec3 b, vec3 c) {
  const vec64 ab = vec_add64(vec_scale64(a, weight[0]), vec_scale64(b, weight[1]));
  return vec_round_saturated(vec_add64(ab, vec_scale64(c, weight[2])), 15);
}

#endif
