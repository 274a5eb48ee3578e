/* SPDX-License-Identifier: Apache-2.0 */
/* Bending forces of the hinges (Bridson, Marino, Fedkiw 2003; Karaoz 2015, 2.49 to 2.58), in every elastic
 * step or every few. SIMD twin: rt/simd/bend_force_lanes.inl.h.
 *
 *   F_i = k |E|^2 / (|N1| + |N2|) sin(t/2) u_i
 *
 * with u_4 = -(...): 2.55 as printed lacks the minus, and the four would not sum to zero. Vertices
 * 1 and 2 are opposite the edge E, 3 and 4 its ends. With heights h and n the unit normals
 *
 *   u1 = n1 / h1, u2 = n2 / h2, u3 = f1 u1 + f2 u2, f = (x - x4).E / |E|^2, u4 = -(u1 + u2 + u3)
 *
 * bend_prepare.c computes what depends on strains alone, once a tick; normals and the angle are computed
 * here. Impulses are Q26, as in membrane_force.c. */
#include "rt/membrane/hinge.h"
#include "rt/membrane/membrane.h"
#include "rt/simd/simd.h"

static vec3 edge_vector(const elastic_position *place, uint32_t from, uint32_t to) {
  return vec_clamp_rare(vec_wrap_sub(vec_of(place[to].at), vec_of(place[from].at)), HINGE_REACH);
}

/* Impulse of a vertex opposite the edge: along its normal, against the fold. */
static vec3 opposite_impulse(int32_t moment, int32_t inverse_height, vec3 normal) {
  const int64_t size = fx_round64(fx_mul_wide(moment, inverse_height), 24);
  return vec_scale_unit(normal, fx_clamp_wide(size, BEND_MAX));
}

/* At the curvature of this moment: linear between the table's entries, constant beyond the last. */
static int32_t stiffness_at(const bend_hinge *c, int32_t half_sine) {
  const uint32_t last = MATERIAL_CURVES - 1;
  const int64_t curvature = fx_asr64(fx_mul_wide(half_sine, c->curvature_scale), 28); /* Q24 */
  if (curvature >> 24 >= last) return c->stiffness[last];
  const uint32_t step = (uint32_t)(curvature >> 24);
  const int32_t rise = fx_sub(c->stiffness[step + 1u], c->stiffness[step]);
  return c->stiffness[step] + fx_mul_round(rise, (int32_t)(curvature & 0xFFFFFF), 24);
}

static void bend(const bend_view *view, const bend_hinge *c) {
  const uint32_t *v = c->vertex;
  const hinge h = hinge_of(edge_vector(view->place, v[2], v[3]), edge_vector(view->place, v[3], v[0]),
                           edge_vector(view->place, v[3], v[1]));
  if (!hinge_is_valid(&h)) return;
  const vec3 n1 = vec_direction_of(h.normal1).unit;
  const vec3 n2 = vec_direction_of(h.normal2).unit;
  const int32_t half_sine = hinge_half_sine(n1, n2);
  const int32_t size = fx_mul_round(stiffness_at(c, half_sine), half_sine, 30);
  const int32_t moment = vec_dot_unit(h.to2, n1) > 0 ? -size : size;
  const vec3 j1 = opposite_impulse(moment, c->height[0], n1);
  const vec3 j2 = opposite_impulse(moment, c->height[1], n2);
  const vec3 j3 = vec_add(vec_scale_q24(j1, c->foot[0]), vec_scale_q24(j2, c->foot[1]));
  elastic_impulse_add(&view->sum[v[0]], j1);
  elastic_impulse_add(&view->sum[v[1]], j2);
  elastic_impulse_add(&view->sum[v[2]], j3);
  elastic_impulse_add(&view->sum[v[3]], vec_negated(vec_add(vec_add(j1, j2), j3)));
}

void bend_force_add(fray_world *w) {
  const bend_view view = {w->membrane.positions, w->membrane.impulse, w->membrane.hinges};
  const uint32_t count = w->membrane.hinge_count;
  uint32_t n = 0;
  FRAY_ASSERT(2u * count <= 3u * triangles_in_use(w));
  while (n < count) {
    n += simd_bend_force(w->kernel, &view, n, count);
    if (n < count) bend(&view, &w->membrane.hinges[n++]);
  }
  w->work.bend_forces += count;
}
