/* SPDX-License-Identifier: Apache-2.0 */
/* The force of stress on the corners of triangles (Karaoz 2015, 2.32), in every elastic step. SIMD twin:
 * rt/simd/membrane_force_lanes.inl.h.
 *
 * Force on corner j, with the area A of a triangle, is -A (r_uj (s_uu U + s_uv V) + r_vj (s_vv V + s_uv U)).
 * membrane_gains.c has A, c and the units in one gain: impulses are Q26.
 *
 *   U, V             Q28    of Q30 edges
 *   strain           Q28
 *   gain * strain    held to 2^31, four bits more than the impulse
 *
 * To the stress comes a 32nd of what it rose by since the last step. Steps make energy of vibrations whose
 * period is a few of them, where they are not linear: sheets that hit the edge of the world, or shook in
 * their own folds, gained up to 47 times the bound of tests/wild. This takes (w h)^2 / 32 of the energy of a
 * frequency w in each step h: 1.6 % of critical damping at w h = 1, next to nothing at 100 Hz. Stability asks
 * for (w h)^2 below 3.76 in place of 4, so beyond the threshold of strain_law.h there is none; with a 16th a
 * sheet that a sword slashes was drawn to three times its length. The first step of a tick has no last one.
 *
 * Corners 1 and 2 get their impulses, corner 0 the opposite of both, so the sum is zero to the last bit. An
 * impulse of a corner is held to 2^26 - 2^22: those of 16 triangles fit 32 bits, with as much as bending and
 * the wind may add. */
#include "rt/membrane/membrane.h"
#include "rt/membrane/strain_law.h"
#include "rt/simd/simd.h"
#include "rt/state/corotational.h"
#include "rt/state/deformation.h"

/* P Q30 and r Q22 to the impulse of a corner along one axis. */
static inline int32_t corner_impulse(int32_t p1, int32_t p2, int32_t r1, int32_t r2) {
  const int64_t sum = fx_mul_wide(p1, r1) + fx_mul_wide(p2, r2);
  return fx_clamp_wide(fx_round64(sum, TRIMESH_WEIGHT_BITS + FORCE_MORE_BITS), FORCE_MAX);
}

/* Impulses of corners 1 and 2 along one axis. */
typedef struct {
  int32_t one, two;
} axis_impulses;
static inline axis_impulses axis_impulses_of(const trimesh_weights *r, int32_t u, int32_t v,
                                             const material_tensor *s) {
  const int32_t p1 = material_round(fx_mul_wide(s->uu, u) + fx_mul_wide(s->uv, v));
  const int32_t p2 = material_round(fx_mul_wide(s->uv, u) + fx_mul_wide(s->vv, v));
  const axis_impulses j = {corner_impulse(p1, p2, r->u1, r->v1), corner_impulse(p1, p2, r->u2, r->v2)};
  return j;
}

/* Q30. */
static vec3 edge_vector(const elastic_position *place, uint32_t from, uint32_t to) {
  return vec_make(elastic_difference(&place[from], &place[to], 0),
                  elastic_difference(&place[from], &place[to], 1),
                  elastic_difference(&place[from], &place[to], 2));
}

/* What is beyond STRAIN_MAX does not count, and its force has no energy. */
static int is_overstretched(material_tensor g) {
  return g.uu == STRAIN_MAX || g.vv == STRAIN_MAX || g.uv == STRAIN_MAX || g.uv == -STRAIN_MAX;
}

static deformation deformation_in_step(const force_view *view, uint32_t t) {
  const index_t *v = view->triangle[t].v;
  return deformation_from_edges(edge_vector(view->place, v[0], v[1]), edge_vector(view->place, v[0], v[2]),
                                &view->weights[t], FX_VELOCITY_BITS + ELASTIC_DIFFERENCE_MORE);
}

static void add_stress(const force_view *view, uint32_t t, const deformation *d,
                       const material_tensor *stress) {
  const index_t *v = view->triangle[t].v;
  const trimesh_weights *r = &view->weights[t];
  const axis_impulses x = axis_impulses_of(r, d->u.x, d->v.x, stress);
  const axis_impulses y = axis_impulses_of(r, d->u.y, d->v.y, stress);
  const axis_impulses z = axis_impulses_of(r, d->u.z, d->v.z, stress);
  elastic_impulse_add(&view->sum[v[0]], vec_make(x.one + x.two, y.one + y.two, z.one + z.two));
  elastic_impulse_add(&view->sum[v[1]], vec_make(-x.one, -y.one, -z.one));
  elastic_impulse_add(&view->sum[v[2]], vec_make(-x.two, -y.two, -z.two));
}

static int32_t damped(const force_view *view, uint32_t at, int32_t stress, int is_stable) {
  const int32_t now = fx_clamp(stress, -STRESS_KEPT_MAX, STRESS_KEPT_MAX);
  const int32_t before = view->last[at];
  view->last[at] = now;
  if (view->has_last == 0 || !is_stable) return stress;
  return fx_add_saturated(stress, fx_round(fx_sub(now, before), STRESS_RISE_BITS));
}

static void damp_stress(const force_view *view, uint32_t t, int is_stable, material_tensor *stress) {
  if (view->last == NULL) return;
  stress->uu = damped(view, t, stress->uu, is_stable);
  stress->vv = damped(view, view->last_stride + t, stress->vv, is_stable);
  stress->uv = damped(view, 2u * view->last_stride + t, stress->uv, is_stable);
}

/* Returns 1 iff it is overstretched: only where the law applies, as no threshold is near STRAIN_MAX. */
static int force_triangle(const force_view *view, uint32_t t) {
  const deformation d = deformation_in_step(view, t);
  const material_tensor strain = material_strain(d.u, d.v);
  material_tensor counted;
  const int is_beyond = strain_law_may_apply(strain, view->strain_threshold[t]);
  material_tensor stress =
      is_beyond ? strain_law_stress(view->gains[t].c, strain, view->strain_threshold[t], &counted)
                : material_stress(view->gains[t].c, strain);
  damp_stress(view, t, !is_beyond, &stress);
  add_stress(view, t, &d, &stress);
  return is_beyond && is_overstretched(strain);
}

#if FRAY_CRACKS
/* Returns 1 iff it is overstretched. */
static int force_corotational(const force_view *view, uint32_t t) {
  const deformation d = deformation_in_step(view, t);
  const material_tensor strain = material_strain(d.u, d.v);
  material_tensor counted;
  material_tensor stress = corotational_stress(view->gains[t].c, strain, &counted);
  damp_stress(view, t, 1, &stress);
  add_stress(view, t, &d, &stress);
  return is_overstretched(strain);
}
#else
#define force_corotational force_triangle
#endif

void membrane_force_add(fray_world *w, force_step_kind kind) {
  FRAY_ASSERT(world_has_membrane(w));
  const uint32_t count = triangles_in_use(w);
  const force_view view = {w->membrane.positions,
                           w->membrane.impulse,
                           w->trimesh.triangle,
                           w->trimesh.weights,
                           w->membrane.gains,
                           w->membrane.strain_threshold,
                           kind == FORCE_MEASURED ? NULL : membrane_last_stress(w),
                           count,
                           kind == FORCE_STEP};
  const int is_corotational = world_is_corotational(w);
  uint32_t left = SIMD_LEFT;
  int is_held = 0;
  for (uint32_t t = 0; t < count;) {
    const uint32_t taken = is_corotational ? simd_corotational_force(w->kernel, &view, t, count)
                                           : simd_membrane_force(w->kernel, &view, t, count);
    t += taken;
    left = simd_left(left, taken);
    for (uint32_t n = 0; n < left && t < count; ++n, ++t)
      is_held |= is_corotational ? force_corotational(&view, t) : force_triangle(&view, t);
  }
  if (is_held) world_fault(w, FRAY_FAULT_OVERSTRETCHED);
  w->work.element_forces += count;
}
