/* SPDX-License-Identifier: Apache-2.0 */
/* The stress of triangles at the beginning of a tick; membrane_tear.c and crack.c tear by it. SIMD twin:
 * rt/simd/membrane_stress_lanes.inl.h.
 *
 *   U, V     what weft and warp have become (2.26, 2.27)       Q28       deformation_of()
 *   G        Green's strain of them (2.28 to 2.31)             Q28       material_strain()
 *   c        stiffness at the smoothed strain (2.59)           Q12 N/m   material_stiffness()
 *   stress   c G (2.60), times membrane_softening(), Q30       Q12 N/m   material_stress()
 *
 * (Karaoz 2015.) Of an isotropic sheet it is T of corotational.h, and c that of its material. Of c
 * membrane_gains_update() makes gains, with which membrane_force.c computes the force in each elastic
 * step.
 *
 * A c that follows the strain changes the energy of a triangle without work. So it rises slowly: in a tick
 * it adds at most what it took before, or a part of the energy, e-fold in 0.17 s (slower, a shirt that a
 * ball breaks through is drawn beyond a strain of 4; faster, cloth that is drawn there makes more than a
 * hundredth). What it has added is `owed`, until stretch_repay.c takes it from the motion that it has
 * become, and does not count as energy until then. */
#include "rt/membrane/membrane.h"
#include "rt/membrane/strain_law.h"
#include "rt/simd/simd.h"
#include "rt/state/corotational.h"
#include "rt/state/deformation.h"

static void lowpass(material_tensor *mean, material_tensor to, unsigned shift) {
  mean->uu += (int32_t)fx_round64((int64_t)to.uu - mean->uu, shift);
  mean->vv += (int32_t)fx_round64((int64_t)to.vv - mean->vv, shift);
  mean->uv += (int32_t)fx_round64((int64_t)to.uv - mean->uv, shift);
}

/* Returns the strain that c goes by. */
static material_tensor smooth_strain(stiffness_state *s, material_tensor strain, unsigned shift) {
  if (shift == 0) return strain;
  for (uint32_t n = 0; n < SMOOTHED_STRAIN_POLES; ++n)
    lowpass(&s->mean[n], n == 0 ? strain : s->mean[n - 1u], shift);
  return s->mean[SMOOTHED_STRAIN_POLES - 1];
}

/* A strain, and what is needed for its energies. */
typedef struct {
  material_tensor strain;
  int is_beyond; /* the threshold of strain_law.h, by the c in use */
} triangle_strain;

static int32_t energy_by(const fray_world *w, uint32_t t, const int32_t c[MATERIAL_ENTRIES],
                         const triangle_strain *s) {
  material_tensor counted = s->strain;
  if (s->is_beyond)
    (void)strain_law_stress(c, s->strain, membrane_threshold_of(w, t, c), &counted);
  return material_energy(material_stress(c, counted), counted, (unsigned)w->membrane.constants->energy_shift);
}

/* As far as it may rise in a tick. */
static void go_towards(int32_t c[MATERIAL_ENTRIES], const int32_t target[MATERIAL_ENTRIES], int32_t rise,
                       int32_t room) {
  const int32_t part =
      rise <= room ? 1 << 30 : (int32_t)fx_divide_wide((uint64_t)(uint32_t)room << 30, (uint32_t)rise);
  for (uint32_t n = 0; n < MATERIAL_ENTRIES; ++n) c[n] += fx_mul_round(target[n] - c[n], part, 30);
}

static void follow(const fray_world *w, uint32_t t, material_tensor strain) {
  stiffness_state *s = &w->membrane.stiffness[t];
  const material_table *f = &w->membrane.materials[w->trimesh.material[t]];
  const unsigned shift = (unsigned)w->membrane.constants->smoothing_shift;
  const int32_t before = w->membrane.strain_threshold[t];
  const int32_t threshold = before != 0 ? before : membrane_threshold_of(w, t, s->c);
  const triangle_strain k = {strain, strain_law_may_apply(strain, threshold)};
  int32_t target[MATERIAL_ENTRIES];
  material_stiffness(f, smooth_strain(s, strain, shift), target);
  if (s->c[0] == 0) {
    go_towards(s->c, target, 0, 0);
    return;
  }
  const int32_t was = energy_by(w, t, s->c, &k);
  const int32_t part = fx_asr(STIFFNESS_RISE * was, shift + STIFFNESS_RISE_BITS);
  const int32_t slowly = fx_max(part, MATERIAL_ENERGY_LEAST);
  const int32_t would = energy_by(w, t, target, &k);
  const int32_t rise = would < MATERIAL_ENERGY_MAX ? would - was : INT32_MAX;
  go_towards(s->c, target, rise, fx_max(-s->owed, slowly));
  const int32_t now = energy_by(w, t, s->c, &k);
  s->owed = fx_clamp(s->owed + now - was, -now, MATERIAL_ENERGY_MAX);
}

static void soften(material_tensor *stress, int32_t softening) {
  if (softening == 1 << 30) return;
  stress->uu = fx_mul_round(stress->uu, softening, 30);
  stress->vv = fx_mul_round(stress->vv, softening, 30);
  stress->uv = fx_mul_round(stress->uv, softening, 30);
}

#if FRAY_CRACKS
/* c is the same at any strain, so none is smoothed. */
static void stress_corotational(const fray_world *w, uint32_t t) {
  FRAY_ASSERT(w->trimesh.area[t] > 0 && w->trimesh.material[t] < w->trimesh.params->materials);
  const deformation d = deformation_of(w, t);
  const int32_t *c = w->membrane.materials[w->trimesh.material[t]].stretch[0];
  w->membrane.stress[t] = corotational_tension(c, material_strain(d.u, d.v));
  soften(&w->membrane.stress[t], membrane_softening(w, t));
}
#else
#define stress_corotational stress_triangle
#endif

static void stress_triangle(const fray_world *w, uint32_t t) {
  FRAY_ASSERT(w->trimesh.area[t] > 0 && w->trimesh.material[t] < w->trimesh.params->materials);
  const deformation d = deformation_of(w, t);
  const material_tensor strain = material_strain(d.u, d.v);
  material_tensor *stress = &w->membrane.stress[t];
  follow(w, t, strain);
  *stress = material_stress(w->membrane.stiffness[t].c, strain);
  soften(stress, membrane_softening(w, t));
}

void membrane_stress_find(fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(world_has_membrane(w) && end <= triangles_in_use(w));
  const trimesh *s = &w->trimesh;
  const membrane_params *c = w->membrane.constants;
  const stress_view view = {{w->p.x, w->p.y, w->p.z}, s->triangle, s->weights, w->membrane.materials,
                            s->material, (unsigned)c->smoothing_shift, (unsigned)c->energy_shift,
                            c->norm2_max, w->membrane.strain_threshold, w->membrane.stiffness,
                            w->membrane.stress};
  const int is_corotational = world_is_corotational(w);
  uint32_t left = SIMD_LEFT;
  for (uint32_t t = first; t < end;) {
    const uint32_t taken = is_corotational ? simd_corotational_stress(w->kernel, &view, t, end)
                                           : simd_membrane_stress(w->kernel, &view, t, end);
    t += taken;
    left = simd_left(left, taken);
    for (uint32_t n = 0; n < left && t < end; ++n, ++t)
      if (is_corotational) stress_corotational(w, t);
      else stress_triangle(w, t);
  }
}

void membrane_stress_update(fray_world *w) { membrane_stress_find(w, 0, triangles_in_use(w)); }
