/* SPDX-License-Identifier: Apache-2.0 */
/* Geometry of a hinge, two triangles with an edge in common: vertices 1 and 2 are opposite the edge, 3 and 4
 * are its ends. SIMD twin: rt/simd/bend_force_lanes.inl.h. */
#ifndef FRAY_MEMBRANE_HINGE_H
#define FRAY_MEMBRANE_HINGE_H

#include "rt/base/vec.h"
#include "rt/state/bend_hinge.h"

typedef struct {
  vec3 edge;             /* from 3 to 4, Q28 */
  vec3 to1, to2;         /* from 4 */
  vec3 normal1, normal2; /* as long as twice the area: (x1 - x3) x (x1 - x4), the other way round for 2 */
} hinge;

static inline hinge hinge_of(vec3 edge, vec3 to1, vec3 to2) {
  const hinge h = {edge, to1, to2, vec_cross_q28(edge, to1), vec_cross_q28(to2, edge)};
  return h;
}

/* Neither triangle is degenerate. */
static inline int hinge_is_valid(const hinge *h) {
  return vec_squared(h->normal1) >= HINGE_MIN && vec_squared(h->normal2) >= HINGE_MIN &&
         vec_squared(h->edge) >= HINGE_MIN;
}

/* sin(t/2) = |n1 - n2| / 2, Q30; exact for small angles, where 2.57 is not. */
static inline int32_t hinge_half_sine(vec3 n1, vec3 n2) {
  const uint64_t squared = vec_squared(vec_asr(vec_wrap_sub(n1, n2), 1));
  return squared == 0 ? 0 : (int32_t)fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
}

#endif
