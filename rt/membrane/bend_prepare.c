/* SPDX-License-Identifier: Apache-2.0 */
/* Constants of the bending hinges for this tick, for bend_force.c. SIMD twin:
 * rt/simd/bend_prepare_lanes.inl.h. Of
 *
 *   F_i = k |E|^2 / (|N1| + |N2|) sin(t/2) u_i        (Karaoz 2015, 2.49 to 2.58)
 *
 * all but the normals and the angle is computed here, from the positions at the beginning of the tick.
 * Heights are h = |N| / |E|. D depends on the angle of the edge at rest against the weft, and on the
 * curvature 2 |n1 - n2| / (h1 + h2), which is that of the moment: a D that lags behind the fold gives it
 * energy.
 *
 * k = 24/5 D: then a strip that bends along the regular mesh has the measured stiffness D. With all
 * edges of the same curvature that is 4 D; but vertices where four triangles meet yield by 1/12
 * of a cell's sag against those where eight do, which takes 1/6 of the energy away.
 *
 * Impulses times height over sin(t/2) are 24/5 D |E|^2 / (|N1| + |N2|) times every h^2 / (i m lu^2) 2^34,
 * which is bend_gain for D in 2^-40 N m (h a substep, i its elastic steps, m a particle's mass). */
#include "rt/membrane/hinge.h"
#include "rt/membrane/membrane.h"
#include "rt/simd/simd.h"

/* Q`bits` of n / d, saturated (d = 0 too: the square of a short edge is rounded to it). */
static int32_t ratio(int64_t n, uint32_t d, unsigned bits) {
  const uint64_t magnitude = (uint64_t)(n < 0 ? -n : n);
  const uint32_t quotient = fx_divide_wide(magnitude << bits, d);
  const int32_t limited = quotient > INT32_MAX ? INT32_MAX : (int32_t)quotient;
  return n < 0 ? -limited : limited;
}

static vec3 edge_vector(const hinge_view *view, uint32_t from, uint32_t to) {
  const int32_t *const *at = view->at;
  const vec3 d = vec_sub(vec_at(at[0], at[1], at[2], to), vec_at(at[0], at[1], at[2], from));
  return vec_mul(vec_clamp_rare(d, HINGE_REACH / 16), 16);
}

/* Angle of an edge at rest against the weft, Q28 of 0..2 for 0 to 90 degrees. 2 (cos, sin) of twice the angle
 * are (u^2 - v^2, 2 u v): mirrored into 0 to 90 degrees. */
static int32_t rest_angle(const hinge_view *view, uint32_t from, uint32_t to) {
  const int64_t u = fx_asr(fx_sub(view->u[to], view->u[from]), 8);
  const int64_t v = fx_asr(fx_sub(view->v[to], view->v[from]), 8);
  const int64_t x = u * u - v * v;
  const int64_t y = 2 * u * v;
  const int32_t cosine = fx_saturate(fx_round64(x, 6));
  const int32_t sine = fx_saturate(fx_round64(y < 0 ? -y : y, 6));
  if (cosine == 0 && sine == 0) return 0;
  return material_direction(cosine / 2, sine / 2) / 2;
}

static int32_t foot_on(vec3 edge, vec3 from_end, uint32_t squared) {
  const int64_t dot = fx_round64(vec_dot64(from_end, edge), 28);
  return fx_clamp(ratio(dot, squared, 24), -2 * (1 << 24), 2 * (1 << 24));
}

/* Fills the stiffness by curvature; `shape` is |E|^2 / (|N1| + |N2|), Q24. */
static void fill_stiffness(const hinge_view *view, const material_table *material, int32_t angle,
                           int32_t shape, bend_hinge *c) {
  const membrane_params *k = view->constants;
  const uint32_t row = angle >= STRAIN_ONE ? 1 : 0;
  const int32_t fraction = angle - (int32_t)(row << STRAIN_BITS);
  for (uint32_t n = 0; n < MATERIAL_CURVES; ++n) {
    const int32_t from = material->bend[row][n];
    const int32_t rise = fx_sub(material->bend[row + 1u][n], from);
    const int32_t d = from + fx_mul_saturated(rise, fraction, STRAIN_BITS);
    c->stiffness[n] = fx_mul_saturated(fx_mul_saturated(d, shape, 24), k->bend_gain, (unsigned)k->bend_shift);
  }
}

/* Returns 0 where a triangle is degenerate. */
static int prepare_hinge(const hinge_view *view, bend_hinge *c) {
  const uint32_t *x = c->vertex;
  const hinge h =
      hinge_of(edge_vector(view, x[2], x[3]), edge_vector(view, x[3], x[0]), edge_vector(view, x[3], x[1]));
  FRAY_ASSERT(bend_hinge_material(c) < MAX_MATERIALS);
  if (!hinge_is_valid(&h)) return 0;
  const uint32_t area1 = vec_length(h.normal1);
  const uint32_t area2 = vec_length(h.normal2);
  const uint32_t edge = vec_length(h.edge);
  const uint32_t squared = (uint32_t)fx_round64((int64_t)vec_squared(h.edge), 28);
  const uint32_t areas = area1 + area2;
  fill_stiffness(view, &view->materials[bend_hinge_material(c)], rest_angle(view, x[2], x[3]),
                 ratio(squared, areas, 24), c);
  /* 2 |n1 - n2| / (h1 + h2) = 4 sin(t/2) |E| / areas */
  c->curvature_scale = fx_mul_saturated(ratio(edge, areas, 24), view->constants->curve_gain, 24);
  c->height[0] = ratio(edge, area1, 16);
  c->height[1] = ratio(edge, area2, 16);
  c->foot[0] = foot_on(h.edge, h.to1, squared);
  c->foot[1] = foot_on(h.edge, h.to2, squared);
  return 1;
}

/* Edges of two triangles, with their vertices and material. */
static uint32_t list_hinges(fray_world *w) {
  const trimesh *s = &w->trimesh;
  uint32_t count = 0;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t)
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t other = s->triangle[t].neighbour[k];
      if (other <= t) continue;
      bend_hinge *c = &w->membrane.hinges[count++];
      c->vertex[0] = s->triangle[t].v[k];
      c->vertex[1] = s->triangle[other].v[trimesh_neighbour_edge(s, t, k)];
      c->vertex[2] = s->triangle[t].v[trimesh_previous(k)];
      c->vertex[3] = s->triangle[t].v[trimesh_next(k)];
      bend_hinge_set_material(c, s->material[t]);
      FRAY_ASSERT(c->vertex[0] < w->p.count && c->vertex[1] < w->p.count && c->vertex[0] != c->vertex[1]);
    }
  FRAY_ASSERT(2u * count <= 3u * w->capacity[POOL_TRIANGLES]);
  return count;
}

/* Degenerate hinges are dropped: those behind them move up. */
void bend_prepare(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w));
  bend_hinge *hinges = w->membrane.hinges;
  const hinge_view view = {{w->p.x, w->p.y, w->p.z}, w->trimesh.u,       w->trimesh.v, w->membrane.materials,
                           w->membrane.constants,       hinges};
  uint32_t count = 0;
  uint32_t at = 0;
  if (w->membrane.constants->bend_every == 0) return;
  const uint32_t listed = list_hinges(w);
  while (at < listed) {
    const uint32_t taken = simd_bend_prepare(w->kernel, &view, at, listed);
    for (uint32_t n = at; count != at && n < at + taken; ++n) hinges[count + n - at] = hinges[n];
    at += taken;
    count += taken;
    if (at == listed) break;
    bend_hinge *c = &hinges[at++];
    if (!prepare_hinge(&view, c)) continue;
    if (c != &hinges[count]) hinges[count] = *c;
    ++count;
  }
  w->membrane.hinge_count = count;
}
