/* SPDX-License-Identifier: Apache-2.0 */
/* What weft and warp of a triangle have become: U = sum of r_u P, V = sum of r_v P (Karaoz
 * 2015, 2.26, 2.27). The weights' sums are zero (2.15; 2.21 as printed contradicts it), so
 * differences to corner 0 are enough. */
#ifndef FRAY_MODEL_ELEMENT_H
#define FRAY_MODEL_ELEMENT_H

#include "rt/model/world.h"

enum {
  ELEMENT_REACH = 4 * FX_LU, /* corners farther apart count as this far */
  ELEMENT_AXIS_MAX = 1 << 30 /* Q28 */
};

typedef struct {
  vec3 u, v; /* Q28 */
} element_axes;

/* Q24 */
static inline int32_t element_way(const int32_t *x, uint32_t from, uint32_t to) {
  return fx_clamp_rare(fx_sub(x[to], x[from]), -ELEMENT_REACH, ELEMENT_REACH);
}
/* Ways in Q`bits` times Q22, to Q28: below 2^62. */
static inline int32_t element_axis(int32_t d1, int32_t d2, int32_t r1, int32_t r2, unsigned bits) {
  const int64_t sum = fx_mul_wide(d1, r1) + fx_mul_wide(d2, r2);
  return (int32_t)fx_clamp64(fx_round64(sum, SHEET_WEIGHT_BITS + bits - STRAIN_BITS), -ELEMENT_AXIS_MAX,
                             ELEMENT_AXIS_MAX);
}

static inline element_axes element_axes_by(vec3 d1, vec3 d2, const sheet_weights *r,
                                           unsigned bits) {
  const element_axes e = {
      {element_axis(d1.x, d2.x, r->u1, r->u2, bits), element_axis(d1.y, d2.y, r->u1, r->u2, bits),
       element_axis(d1.z, d2.z, r->u1, r->u2, bits)},
      {element_axis(d1.x, d2.x, r->v1, r->v2, bits), element_axis(d1.y, d2.y, r->v1, r->v2, bits),
       element_axis(d1.z, d2.z, r->v1, r->v2, bits)}};
  return e;
}

/* Of a triangle where its vertices are between ticks. */
static inline element_axes element_axes_of(const fray_world *w, uint32_t t) {
  const row_id *v = w->sheet.triangle[t].v;
  const vec3 d1 = {element_way(w->x, v[0], v[1]) * 16, element_way(w->y, v[0], v[1]) * 16,
                   element_way(w->z, v[0], v[1]) * 16};
  const vec3 d2 = {element_way(w->x, v[0], v[2]) * 16, element_way(w->y, v[0], v[2]) * 16,
                   element_way(w->z, v[0], v[2]) * 16};
  return element_axes_by(d1, d2, &w->sheet.weights[t], STRAIN_BITS);
}

#endif
