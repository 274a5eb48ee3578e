/* SPDX-License-Identifier: Apache-2.0 */
/* What a triangle's bending has made by a change of its stiffness (bend_owed.c) is taken from the motion of
 * its folds, in the first elastic step of a tick: along the gradient of the angle of each (bend_force.c). */
#include "rt/elastic/step_repay.h"
#include "rt/membrane/membrane.h"

enum { GRADIENT_BITS = 20, GRADIENT_MAX = 1 << 29 };

/* Of the angle of side k of triangle t, at its corners, times the length of the side: -(e_k . e_i) / |N|. */
static void angle_gradient(const fray_world *w, uint32_t t, uint32_t k, int32_t g[3]) {
  const index_t *v = w->trimesh.triangle[t].v;
  const int32_t per_area = w->membrane.normals[t].per_area;
  const vec3 along = bend_edge(w->membrane.positions, v[trimesh_next(k)], v[trimesh_previous(k)]);
  int64_t sum = 0;
  for (uint32_t n = 0; n < 3; ++n) {
    const uint32_t i = (k + n) % 3u;
    const vec3 e = bend_edge(w->membrane.positions, v[trimesh_next(i)], v[trimesh_previous(i)]);
    const int32_t dot = fx_saturate(fx_round64(vec_dot64(along, e), 28));
    const unsigned shift = 30u + (unsigned)(per_area & BEND_EXPONENT) - GRADIENT_BITS;
    g[i] = -fx_clamp_wide(fx_round64(fx_mul_wide(dot, per_area & ~BEND_EXPONENT), shift), GRADIENT_MAX);
    sum += g[i];
  }
  g[k] = fx_saturate(g[k] - sum);
}

/* Up or down to the bits of a motion. */
static vec3 scaled(vec3 normal, int32_t g, unsigned up) {
  return vec_scale_unit(normal, (int32_t)fx_asr64((int64_t)g * ((int64_t)1 << up), 32 - STEP_MOTION_BITS));
}

static step_motion motion_of(const fray_world *w, uint32_t t, uint32_t k) {
  const trimesh *s = &w->trimesh;
  const uint32_t other = s->triangle[t].neighbour[k];
  const uint32_t back = trimesh_neighbour_edge(s, t, k);
  const vec3 one = vec_of(w->membrane.normals[t].n);
  const vec3 two = vec_of(w->membrane.normals[other].n);
  int32_t g[3];
  int32_t h[3];
  angle_gradient(w, t, k, g);
  angle_gradient(w, other, back, h);
  uint32_t most = 1;
  for (uint32_t n = 0; n < 3; ++n) most |= fx_magnitude(g[n]) | fx_magnitude(h[n]);
  const unsigned up = fx_leading_zeros64(most) - 32u;
  const uint32_t next = trimesh_next(k);
  const uint32_t last = trimesh_previous(k);
  const index_t *v = s->triangle[t].v;
  const step_motion motion = {
      STEP_MOTION_VERTICES,
      {v[k], v[next], v[last], s->triangle[other].v[back]},
      {scaled(one, g[k], up),
       vec_add(scaled(one, g[next], up), scaled(two, h[trimesh_previous(back)], up)),
       vec_add(scaled(one, g[last], up), scaled(two, h[trimesh_next(back)], up)),
       scaled(two, h[back], up)}};
  return motion;
}

/* From energies to the format of `owed`, Q(bend_bits - 3) in a bending step. */
static step_energy_unit unit_of(const fray_world *w, const elastic_step *step) {
  const membrane_params *c = w->membrane.constants;
  const uint64_t by = fx_mul_wide_u((uint32_t)step->part, (uint32_t)c->bend_every);
  const step_energy_unit unit = {by > INT32_MAX ? INT32_MAX : (uint32_t)by, 31 + 3 - c->bend_bits};
  return unit;
}

void bend_repay(fray_world *w, const elastic_step *step) {
  const trimesh_triangle *triangle = w->trimesh.triangle;
  const step_energy_unit unit = unit_of(w, step);
  FRAY_ASSERT(world_has_membrane(w));
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) {
    int32_t *const owed = &w->membrane.bend_states[t].owed;
    for (uint32_t k = 0; k < 3 && *owed > 0; ++k) {
      if (triangle[t].neighbour[k] == t) continue;
      const step_motion motion = motion_of(w, t, k);
      *owed = step_repay(w, &motion, *owed, unit, step);
    }
  }
}
