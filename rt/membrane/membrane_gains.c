/* SPDX-License-Identifier: Apache-2.0 */
/* What the elastic steps multiply by, once a tick, after tears and cuts have divided areas and masses:
 * inverse masses of vertices, gains of triangles, constants of bending.
 *
 * Impulses are in masses of a particle times Q26 lu per substep. With the stress in N/m, the area A in lu^2,
 * a weight r in 1/lu, a substep of h, i elastic steps and a particle of m
 *
 *   impulse = A r s U h^2 / (i m) 2^26:   gain(A, c) = A c h^2 / (i m) 2^30, so stress has four bits more
 *
 * with c at the smoothed strain (state/material.h), or the one of an isotropic sheet. */
#include "rt/membrane/membrane.h"
#include "rt/membrane/strain_law.h"

enum { SOFTENED = 751619277 /* 7/10 in Q30 */ };

/* Elastic steps of this length bear norm2_max, in small motion: what a tear leaves beyond it has no neighbour
 * that holds it back and is soon far from its shape, so it keeps 7/10 of what could be borne. */
int32_t membrane_softening_of(const fray_world *w, const trimesh_weights *weights) {
  const trimesh_gram gram = trimesh_gram_of(weights);
  const uint32_t max = (uint32_t)w->membrane.constants->norm2_max;
  if (trimesh_gram_is_within(&gram, max)) return 1 << 30;
  const uint32_t norm2 = trimesh_norm2(&gram);
  /* halves: a divisor is at most 2^31 */
  return (int32_t)fx_divide_wide((uint64_t)max * (SOFTENED / 2), norm2 / 2u);
}

/* The stiffest mode of gains, in their format: of a strain both ways, or of shear. */
static uint32_t stiffest_mode(const int32_t c[MATERIAL_ENTRIES]) {
  const int32_t apart = fx_sub(c[0], c[2]);
  const uint64_t squared = (fx_square(apart) >> 2) + fx_square(c[1]);
  const uint32_t root = squared == 0 ? 0 : fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
  const uint32_t both = (uint32_t)(((uint64_t)(uint32_t)c[0] + (uint32_t)c[2]) >> 1) + root + 1u;
  const uint32_t shear = 2u * (uint32_t)c[3];
  return both > shear ? both : shear;
}

/* w^2 h^2 at rest is mode norm2 over what a corner weighs, its area / mass_unit, and the steps. */
static int32_t threshold_of(const fray_world *w, uint32_t t, const int32_t c[MATERIAL_ENTRIES]) {
  const trimesh_gram gram = trimesh_gram_of(&w->trimesh.weights[t]);
  const uint64_t slope = fx_mul_wide_u(stiffest_mode(c), trimesh_norm2(&gram)) >> 22; /* Q20 */
  const uint32_t weighs =
      fx_divide_wide((uint64_t)w->trimesh.area[t] << 30, (uint32_t)w->membrane.constants->mass_unit);
  return strain_law_threshold(slope > INT32_MAX ? INT32_MAX : (uint32_t)slope, weighs,
                              (uint32_t)w->membrane.constants->steps);
}

int32_t membrane_gain_of(const fray_world *w, uint32_t t) {
  const int32_t area = fx_mul_round((int32_t)w->trimesh.area[t], membrane_softening(w, t), 30);
  return fx_mul_round(area, w->membrane.constants->force_gain, 30);
}

int32_t membrane_threshold_of(const fray_world *w, uint32_t t, const int32_t stiffness[MATERIAL_ENTRIES]) {
  const int32_t gain = membrane_gain_of(w, t);
  int32_t c[MATERIAL_ENTRIES];
  for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n)
    c[n] = fx_mul_saturated(stiffness[n], gain, (unsigned)w->membrane.constants->force_shift);
  return threshold_of(w, t, c);
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
  const int is_corotational = world_is_corotational(w);
  update_inverse_masses(w);
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) {
    FRAY_ASSERT(s->area[t] > 0 && s->area[t] < TRIMESH_AREA_MAX);
    int32_t *c = w->membrane.gains[t].c;
    const int32_t *from =
        is_corotational ? w->membrane.materials[s->material[t]].stretch[0] : w->membrane.stiffness[t].c;
    const int32_t gain = membrane_gain_of(w, t);
    for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n)
      c[n] = fx_mul_saturated(from[n], gain, shift);
    w->membrane.strain_threshold[t] = is_corotational ? STRAIN_LAW_MAX : threshold_of(w, t, c);
  }
  bend_prepare(w);
}
