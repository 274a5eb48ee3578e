/* SPDX-License-Identifier: Apache-2.0 */
/* Elastic energies of a membrane, with the constants of its tick.
 *
 *   stretch, shear   stress times strain over 2, summed over triangles: the uu and vv of it, and the uv
 *   bend             delta H delta over 2 (membrane/bend_force.c), summed over triangles
 *                    both less what triangles owe
 *   form             half of velocity times the impulse of an elastic step
 *
 * A gain times a strain is the impulse of one of n elastic steps, so energies are n times that. Moments
 * come in every `bend_every`-th of them. */
#include "rt/energy/energy_measure.h"
#include "rt/membrane/membrane.h"
#include "rt/membrane/strain_law.h"
#include "rt/state/corotational.h"
#include "rt/state/deformation.h"

#if FRAY_ENERGY

static vec3 edge_vector(const fray_world *w, uint32_t from, uint32_t to) {
  const vec3 whole = vec_mul(vec_clamp_rare(vec_sub(world_position(w, to), world_position(w, from)),
                                            DEFORMATION_REACH - 1),
                             1 << FX_SUB_BITS);
  const uint32_t attached = particles_attached(w);
  const vec3 a =
      from < attached ? vec_make(0, 0, 0) : vec_make(w->p.rx[from], w->p.ry[from], w->p.rz[from]);
  const vec3 b =
      to < attached ? vec_make(0, 0, 0) : vec_make(w->p.rx[to], w->p.ry[to], w->p.rz[to]);
  return vec_add(whole, vec_sub(b, a));
}

/* The strain whose product with c is stress, and twice the energy. */
static material_tensor counted_strain(const fray_world *w, uint32_t t, material_tensor strain) {
  const int32_t *c = w->membrane.gains[t].c;
  material_tensor counted = strain;
#if FRAY_CRACKS
  if (world_is_corotational(w)) {
    (void)corotational_stress(c, strain, &counted);
    return counted;
  }
#endif
  if (strain_law_may_apply(strain, w->membrane.strain_threshold[t]))
    (void)strain_law_stress(c, strain, w->membrane.strain_threshold[t], &counted);
  return counted;
}

/* What a stiffness that followed the strain has made, and motion has not repaid (membrane_stress.c). */
static wide_number owed_by(const fray_world *w, uint32_t t) {
  const membrane_params *c = w->membrane.constants;
  const int64_t owed = (int64_t)w->membrane.stiffness[t].owed * ((int64_t)1 << c->energy_shift);
  return wide_product(owed, membrane_gain_of(w, t), 58u + (uint32_t)c->force_shift);
}

static void measure_triangles(const fray_world *w, energy_stored *e) {
  const uint32_t triangles = triangles_in_use(w);
  const int64_t steps = w->membrane.constants->steps;
  wide_number normal = {0, 0};
  wide_number shear = {0, 0};
  FRAY_ASSERT(triangles <= w->capacity[POOL_TRIANGLES]);
  for (uint32_t t = 0; t < triangles; ++t) {
    const index_t *v = w->trimesh.triangle[t].v;
    const deformation d =
        deformation_from_edges(edge_vector(w, v[0], v[1]), edge_vector(w, v[0], v[2]),
                               &w->trimesh.weights[t], FX_VELOCITY_BITS);
    const material_tensor strain = counted_strain(w, t, material_strain(d.u, d.v));
    const material_tensor stress = material_stress(w->membrane.gains[t].c, strain); /* Q30 */
    normal = wide_add(
        normal, wide_of(fx_mul_wide(stress.uu, strain.uu) + fx_mul_wide(stress.vv, strain.vv), 58));
    shear = wide_add(shear, wide_of(fx_mul_wide(stress.uv, strain.uv), 58));
    normal = wide_sub(normal, owed_by(w, t));
  }
  e->stretch = wide_times(normal, steps, 1);
  e->shear = wide_times(shear, steps, 1);
}

/* Half of delta H delta over all triangles. */
static void measure_bending(fray_world *w, energy_stored *e) {
  const int64_t every = w->membrane.constants->bend_every;
  const uint32_t triangles = triangles_in_use(w);
  const uint32_t bits = (uint32_t)w->membrane.constants->bend_bits;
  wide_number sum = {0, 0};
  e->bend = sum;
  if (every == 0) return;
  membrane_angles_find(w);
  for (uint32_t t = 0; t < triangles; ++t) {
    const int32_t *angle = w->membrane.moments[t].side;
    for (uint32_t k = 0; k < 3; ++k)
      sum = wide_add(sum, wide_product(bend_plate_moment(w, t, k), angle[k], bits + 2u * BEND_ANGLE_BITS));
    sum = wide_sub(sum, wide_of(w->membrane.bend_states[t].owed, bits - 4u)); /* twice: bend_owed.c */
  }
  e->bend = wide_over(wide_times(sum, (int64_t)w->membrane.constants->steps, 1), (uint32_t)every);
}

static void measure_form(fray_world *w, energy_stored *e) {
  enum { POWER_BITS = FX_VELOCITY_BITS + ELASTIC_IMPULSE_BITS + 1 };
  const wide_number nothing = {0, 0};
  e->form = nothing;
  for (uint32_t b = 0; b < MAX_BODIES; ++b)
    for (uint32_t n = 0; n < 3; ++n) e->pull[b][n] = nothing;
  membrane_impulses_now(w);
  for (uint32_t p = 0; p < w->p.count; ++p) {
    const vec3 j = elastic_impulse_vec(&w->membrane.impulse[p]);
    if (particle_is_attached(w, p)) {
      wide_number *pull = e->pull[w->p.attach_body[p]];
      pull[0] = wide_add(pull[0], wide_of(j.x, ELASTIC_IMPULSE_BITS + 1));
      pull[1] = wide_add(pull[1], wide_of(j.y, ELASTIC_IMPULSE_BITS + 1));
      pull[2] = wide_add(pull[2], wide_of(j.z, ELASTIC_IMPULSE_BITS + 1));
      continue;
    }
    const vec3 v = energy_velocity(w, p);
    e->form = wide_add(e->form, wide_of(fx_mul_wide(v.x, j.x), POWER_BITS));
    e->form = wide_add(e->form, wide_of(fx_mul_wide(v.y, j.y), POWER_BITS));
    e->form = wide_add(e->form, wide_of(fx_mul_wide(v.z, j.z), POWER_BITS));
  }
}

void energy_measure_membrane(fray_world *w, energy_stored *e) {
  FRAY_ASSERT(world_has_membrane(w));
  const wide_number nothing = {0, 0};
  e->yarns = nothing;
  measure_triangles(w, e);
  measure_bending(w, e);
  measure_form(w, e);
}

#endif
