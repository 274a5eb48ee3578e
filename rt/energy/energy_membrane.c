/* SPDX-License-Identifier: Apache-2.0 */
/* Elastic energies of a membrane, with the constants of its tick.
 *
 *   stretch, shear   stress times strain over 2, summed over triangles: the uu and vv of it, and
 * the uv bend             the moment of a hinge, integrated over its angle form             half of
 * velocity times the impulse of an elastic step
 *
 * A gain times a strain is the impulse of one of n elastic steps, so energies are n times that. A
 * hinge of half sine s has the moment M = k(s) s, with k linear between the curvatures of its
 * table, and gives it in every `bend_every`-th elastic step. With c = sqrt(1 - s^2), d(angle) = 2
 * ds / c, so in parts
 *
 *   energy = 2 k(s) (1 - c(s)) - sum over the table's steps of 2 dk mean(1 - c)
 *
 * where the mean over a step is Simpson's: within 0.2 % of it where the step ends at 60 degrees, 1
 * % at 90. */
#include "rt/energy/energy_measure.h"
#include "rt/membrane/hinge.h"
#include "rt/membrane/membrane.h"
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
    const material_tensor strain = material_strain(d.u, d.v);
    const material_tensor stress = material_stress(w->membrane.gains[t].c, strain); /* Q30 */
    normal = wide_add(
        normal, wide_of(fx_mul_wide(stress.uu, strain.uu) + fx_mul_wide(stress.vv, strain.vv), 58));
    shear = wide_add(shear, wide_of(fx_mul_wide(stress.uv, strain.uv), 58));
  }
  e->stretch = wide_times(normal, steps, 1);
  e->shear = wide_times(shear, steps, 1);
}

enum { SAGITTA_BITS = 38, STIFFNESS_BITS = 34 };

/* 1 - sqrt(1 - s^2), as s^2 / (1 + sqrt(1 - s^2)); s: Q30, 0 to 1. */
static int64_t sagitta_of(int64_t half_sine) {
  const int64_t squared = half_sine * half_sine;
  const int64_t rest = ((int64_t)1 << 60) - squared;
  const int64_t cosine =
      rest > 0 ? (int64_t)fx_root_length(fx_rsqrt((uint64_t)rest, FX_ROOT_FINE)) : 0;
  return squared / ((((int64_t)1 << 30) + cosine) >> (SAGITTA_BITS - 30));
}

/* Half of it. */
static wide_number hinge_energy(const bend_hinge *c, int64_t half_sine) {
  enum { LAST = MATERIAL_CURVES - 1 };
  wide_number energy = {0, 0};
  int64_t stiffness = c->stiffness[0];
  int64_t from = 0; /* half sine where a step of the table begins */
  for (int64_t n = 0; n < LAST && from < half_sine && c->curvature_scale > 0; ++n) {
    const int64_t end = ((n + 1) * ((int64_t)1 << 52)) / c->curvature_scale;
    const int64_t to = end < half_sine ? end : half_sine;
    const int64_t rise = (int64_t)c->stiffness[n + 1] - c->stiffness[n];
    const int64_t gained = end > from ? rise * (to - from) / (end - from) : 0;
    const int64_t mean = (sagitta_of(from) + 4 * sagitta_of((from + to) / 2) + sagitta_of(to)) / 6;
    energy = wide_sub(energy, wide_product(gained, mean, STIFFNESS_BITS + SAGITTA_BITS));
    stiffness += gained;
    from = to;
  }
  return wide_add(energy,
                  wide_product(stiffness, sagitta_of(half_sine), STIFFNESS_BITS + SAGITTA_BITS));
}

static void measure_hinges(const fray_world *w, energy_stored *e) {
  const int64_t every = w->membrane.constants->bend_every;
  wide_number sum = {0, 0};
  e->bend = sum;
  if (every == 0) return;
  for (uint32_t n = 0; n < w->membrane.hinge_count; ++n) {
    const bend_hinge *c = &w->membrane.hinges[n];
    const uint32_t *v = c->vertex;
    const hinge h = hinge_of(vec_clamp(edge_vector(w, v[2], v[3]), HINGE_REACH),
                             vec_clamp(edge_vector(w, v[3], v[0]), HINGE_REACH),
                             vec_clamp(edge_vector(w, v[3], v[1]), HINGE_REACH));
    if (!hinge_is_valid(&h)) continue;
    const int32_t half_sine =
        hinge_half_sine(vec_direction_of(h.normal1).unit, vec_direction_of(h.normal2).unit);
    sum = wide_add(sum, hinge_energy(c, fx_min(half_sine, (1 << 30) - 1)));
  }
  e->bend =
      wide_over(wide_times(sum, 4 * (int64_t)w->membrane.constants->steps, 1), (uint32_t)every);
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
  measure_hinges(w, e);
  measure_form(w, e);
}

#endif
