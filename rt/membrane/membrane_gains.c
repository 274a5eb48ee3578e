/* SPDX-License-Identifier: Apache-2.0 */
/* What the elastic steps multiply by, once a tick, after tears and cuts have divided areas and masses:
 * inverse masses of vertices, gains of triangles, constants of hinges.
 *
 * Impulses are in masses of a particle times Q26 lu per substep. With the stress in N/m, the area A in lu^2,
 * a weight r in 1/lu, a substep of h, i elastic steps and a particle of m
 *
 *   impulse = A r s U h^2 / (i m) 2^26:   gain(A, c) = A c h^2 / (i m) 2^30, so stress has four bits more
 *
 * with c at the smoothed strain (state/material.h). */
#include "rt/membrane/membrane.h"

enum { SOFTENED = 751619277 /* 7/10 in Q30 */ };

/* Elastic steps of this length can bear weights up to weight2_max. The square of a weight's length is that of
 * 1 / height. A right triangle vibrates at most by 1.6 of the largest, a flat one by 2 of it, and with no
 * neighbour that holds it back: it keeps 7/10 of what could be borne. */
int32_t membrane_softening(const fray_world *w, uint32_t t) {
  FRAY_ASSERT(t < triangles_in_use(w));
  const trimesh_weights *r = &w->trimesh.weights[t];
  const uint64_t squares[3] = {fx_square(r->u1) + fx_square(r->v1), fx_square(r->u2) + fx_square(r->v2),
                               fx_square(fx_add(r->u1, r->u2)) + fx_square(fx_add(r->v1, r->v2))};
  const uint64_t larger = squares[0] > squares[1] ? squares[0] : squares[1];
  const uint64_t largest = (larger > squares[2] ? larger : squares[2]) >> 32; /* Q12 */
  const uint32_t limit = (uint32_t)w->membrane.constants->weight2_max;
  return largest <= limit ? 1 << 30 : (int32_t)fx_divide_wide((uint64_t)limit * SOFTENED, (uint32_t)largest);
}

static void update_inverse_masses(fray_world *w) {
  const uint64_t unit = (uint64_t)(uint32_t)w->membrane.constants->mass_unit << ELASTIC_INVERSE_BITS;
  for (uint32_t p = 0; p < w->p.count; ++p) {
    FRAY_ASSERT(w->trimesh.mass[p] > 0); /* every vertex has a triangle */
    const uint32_t inverse = fx_divide_wide(unit, w->trimesh.mass[p]);
    w->membrane.inverse_mass[p] = inverse > INT32_MAX ? INT32_MAX : (int32_t)inverse;
  }
}

void membrane_gains_update(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w));
  const trimesh *s = &w->trimesh;
  const unsigned shift = (unsigned)w->membrane.constants->force_shift;
  update_inverse_masses(w);
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) {
    FRAY_ASSERT(s->area[t] > 0 && s->area[t] < TRIMESH_AREA_MAX);
    int32_t *c = w->membrane.gains[t].c;
    const int32_t area = fx_mul_round((int32_t)s->area[t], membrane_softening(w, t), 30);
    const int32_t gain = fx_mul_round(area, w->membrane.constants->force_gain, 30);
    for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n)
      c[n] = fx_mul_saturated(c[n], gain, shift);
  }
  bend_prepare(w);
}
