/* SPDX-License-Identifier: Apache-2.0 */
/* Deformation gradient of a triangle by its columns, U and V: what weft and warp have become. U = sum of r_u
 * P, V = sum of r_v P (Karaoz 2015, 2.26, 2.27). The weights' sums are zero (2.15; 2.21 as printed
 * contradicts it), so differences to corner 0 are enough. */
#ifndef FRAY_STATE_DEFORMATION_H
#define FRAY_STATE_DEFORMATION_H

#include "rt/state/world.h"

enum {
  DEFORMATION_REACH = 4 * FX_LU, /* corners farther apart along an axis are taken as this far */
  DEFORMATION_AXIS_MAX = 1 << 30 /* Q28 */
};

typedef struct {
  vec3 u, v; /* Q28 */
} deformation;

/* Q24 */
static inline vec3 deformation_edge(const fray_world *w, uint32_t from, uint32_t to) {
  return vec_clamp_rare(vec_sub(world_position(w, to), world_position(w, from)), DEFORMATION_REACH);
}
/* Edges in Q`bits` times weights in Q22, to Q28: below 2^62. */
static inline int32_t deformation_axis(int32_t d1, int32_t d2, int32_t r1, int32_t r2, unsigned bits) {
  const int64_t sum = fx_mul_wide(d1, r1) + fx_mul_wide(d2, r2);
  return fx_clamp_wide(fx_round64(sum, TRIMESH_WEIGHT_BITS + bits - STRAIN_BITS), DEFORMATION_AXIS_MAX);
}

static inline deformation deformation_from_edges(vec3 d1, vec3 d2, const trimesh_weights *r, unsigned bits) {
  const deformation e = {
      {deformation_axis(d1.x, d2.x, r->u1, r->u2, bits), deformation_axis(d1.y, d2.y, r->u1, r->u2, bits),
       deformation_axis(d1.z, d2.z, r->u1, r->u2, bits)},
      {deformation_axis(d1.x, d2.x, r->v1, r->v2, bits), deformation_axis(d1.y, d2.y, r->v1, r->v2, bits),
       deformation_axis(d1.z, d2.z, r->v1, r->v2, bits)}};
  return e;
}

/* Of a triangle, from the positions between ticks. */
static inline deformation deformation_of(const fray_world *w, uint32_t t) {
  const index_t *v = w->trimesh.triangle[t].v;
  FRAY_ASSERT(t < triangles_in_use(w) && v[0] < w->p.count && v[1] < w->p.count && v[2] < w->p.count);
  return deformation_from_edges(vec_mul(deformation_edge(w, v[0], v[1]), 16),
                                vec_mul(deformation_edge(w, v[0], v[2]), 16), &w->trimesh.weights[t],
                                STRAIN_BITS);
}

#endif
