/* SPDX-License-Identifier: Apache-2.0 */
/* The membrane's last resort, each substep: an edge longer than `edge_limit` times its rest length is
 * shortened to that by projection, one edge after the other, each once, and its ends stop separating. The
 * limit is above the strain at which cloth tears, and so hides no stress below that. Positions move without
 * changing velocities: a load that holds a membrane at its limit would otherwise shake it. No SIMD twin:
 * edges follow one another. */
#include "rt/membrane/membrane.h"
#include "rt/state/deformation.h"

/* Moves both ends towards each other along one axis, by `product` 2^-30 together: end i by its fraction of
 * that, which is inverse mass over the sum of both; to +-limit. */
static void approach(int32_t *a, uint32_t i, uint32_t j, int64_t product, int64_t fraction_q24,
                     int32_t limit) {
  const int64_t whole = fx_round64(product, 30);
  const int64_t of_i = fx_round64(whole * fraction_q24, 24);
  a[i] = fx_clamp_wide(a[i] + of_i, limit);
  a[j] = fx_clamp_wide(a[j] - (whole - of_i), limit);
}

static void shorten(fray_world *w, uint32_t i, uint32_t j) {
  FRAY_ASSERT(i < w->p.count && j < w->p.count && i != j);
  const trimesh *s = &w->trimesh;
  const uint32_t attached = particles_attached(w);
  const uint64_t rest2 = fx_square(fx_sub(s->u[j], s->u[i])) + fx_square(fx_sub(s->v[j], s->v[i]));
  const vec3 d = deformation_edge(w, i, j);
  const uint64_t length2 = vec_squared(d);
  if (rest2 == 0 || length2 <= rest2) return;
  const uint64_t rest = fx_root_length(fx_rsqrt(rest2, FX_ROOT_FINE));
  const fx_root root = fx_rsqrt(length2, FX_ROOT_FINE);
  const uint64_t length = fx_root_length(root);
  const uint64_t limit = rest * (uint32_t)w->membrane.constants->edge_limit >> 16;
  const uint64_t inverse_i = i < attached ? 0 : (uint32_t)w->membrane.inverse_mass[i];
  const uint64_t inverse_j = j < attached ? 0 : (uint32_t)w->membrane.inverse_mass[j];
  if (length <= limit || inverse_i + inverse_j == 0) return;
  const int64_t fraction = (int64_t)((inverse_i << 24) / (inverse_i + inverse_j));
  const vec3 unit = vec_root_unit(root, d);
  const vec3 velocity = vec_sub_saturated(world_velocity(w, j), world_velocity(w, i));
  const int32_t separating = vec_dot_unit(velocity, unit);
  const int32_t units[3] = {unit.x, unit.y, unit.z};
  int32_t *const positions[3][2] = {{w->p.x, w->p.qx}, {w->p.y, w->p.qy}, {w->p.z, w->p.qz}};
  int32_t *const velocities[3] = {w->p.vx, w->p.vy, w->p.vz};
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t product = (int64_t)(length - limit) * units[n];
    approach(positions[n][0], i, j, product, fraction, FX_EDGE_MAX);
    approach(positions[n][1], i, j, product, fraction, FX_WORLD_MAX);
    if (separating > 0)
      approach(velocities[n], i, j, (int64_t)separating * units[n], fraction, FX_SPEED_OVER);
  }
}

void edge_limit_apply(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w));
  if (w->membrane.constants->edge_limit == 0) return;
  const trimesh *s = &w->trimesh;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (s->triangle[t].neighbour[k] >= t)
        shorten(w, s->triangle[t].v[trimesh_next(k)], s->triangle[t].v[trimesh_previous(k)]);
}
