/* SPDX-License-Identifier: Apache-2.0 */
/* Tears the membrane, once a tick (Karaoz 2015, sections 2.7, 3.1, 3.2, 3.5): of all lines through all
 * vertices, the one whose separation strength is largest relative to the strength that the material requires
 * in its direction, if it is above that. One a tick for each material, and none for `cooldown` ticks after
 * that, in which the stress finds its new balance.
 *
 *   separation of a line     separation.h; from the stress of membrane_stress.c, at the beginning of the tick
 *   candidates               along the ring edges of a vertex, and through the middle of the edges opposite
 *   the split                trimesh_split(): beyond the vertex of a closed ring it may follow a ring
 *                            edge next to the line
 *
 * Lines that cannot be split (an attached vertex, a sliver) take no part. */
#include "rt/membrane/membrane.h"
#include "rt/membrane/separation.h"
#include "rt/trimesh/trimesh_split.h"

typedef struct {
  uint32_t vertex;
  separation_ratio ratio;
} tear;

/* No less than the largest principal stress. */
static int32_t principal_bound(material_tensor s) {
  const int64_t bound = (int64_t)(s.uu > s.vv ? s.uu : s.vv) + fx_magnitude(s.uv);
  return (int32_t)fx_clamp64(bound, 0, 2 * SEPARATION_STRESS_MAX);
}

/* The bound of each vertex's triangles, in `x` of the impulse sums: no elastic step of this tick has begun
 * yet. */
static void find_max_stress(fray_world *w) {
  elastic_impulse *const max_stress = w->membrane.max_stress;
  for (uint32_t p = 0; p < w->p.count; ++p) max_stress[p].x = 0;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) {
    const int32_t bound = principal_bound(w->membrane.stress[t]);
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t p = w->trimesh.triangle[t].v[k];
      max_stress[p].x = fx_max(max_stress[p].x, bound);
    }
  }
}

static separation_direction rest_edge(const trimesh *s, uint32_t from, uint32_t to) {
  const separation_direction d = {fx_sub(s->u[to], s->u[from]), fx_sub(s->v[to], s->v[from])};
  return d;
}

static void gather_ring(const fray_world *w, uint32_t vertex, const trimesh_ring *ring, separation_ring *r) {
  const trimesh *s = &w->trimesh;
  r->count = ring->count;
  r->closed = ring->closed;
  for (uint32_t n = 0; n < ring->count; ++n) {
    const uint32_t t = ring->triangle[n];
    const uint32_t k = ring->corner[n];
    const sym2 stress = {w->membrane.stress[t].uu, w->membrane.stress[t].vv, w->membrane.stress[t].uv};
    r->edge[n] = rest_edge(s, vertex, s->triangle[t].v[trimesh_next(k)]);
    r->edge[n + 1u] = rest_edge(s, vertex, s->triangle[t].v[trimesh_previous(k)]);
    r->stress[n] = stress;
  }
  separation_prepare(r);
}

/* The ray of a candidate, in the ring that it was found in. */
static trimesh_ray ray_of(uint32_t candidate) {
  const trimesh_ray ray = {candidate / 2u, candidate % 2u == 0 ? 0 : TRIMESH_WEIGHT_ONE / 2};
  return ray;
}

/* The other half of a line through a closed ring. */
static trimesh_ray opposite_of(const trimesh *s, const trimesh_ring *ring, uint32_t vertex,
                               const separation_ratio *r) {
  trimesh_ray ray = {r->opposite, TRIMESH_WEIGHT_ONE / 2};
  (void)trimesh_ray_along(s, ring, trimesh_at(s, vertex), -r->line.u, -r->line.v, &ray);
  return ray;
}

static int can_tear(const fray_world *w, uint32_t vertex, const trimesh_ring *ring,
                    const separation_ratio *r) {
  const trimesh_ray from = ray_of(r->candidate);
  const trimesh_ray to = opposite_of(&w->trimesh, ring, vertex, r);
  return trimesh_can_split(w, vertex, &from, &to) == TRIMESH_FITS;
}

/* Takes the best line through a vertex if it is better than `best`. */
static void test_vertex(fray_world *w, uint32_t vertex, const tear_strength *strength, tear *best) {
  FRAY_ASSERT(vertex < w->p.count);
  trimesh_ring ring;
  separation_ring f;
  trimesh_ring_of(&w->trimesh, vertex, &ring);
  gather_ring(w, vertex, &ring, &f);
  for (uint32_t n = separation_first(&f); n < separation_end(&f); ++n) {
    const separation_ratio r = separation_ratio_of(&f, n, strength->strength);
    if (r.separation <= r.required || !separation_exceeds(&r, &best->ratio) ||
        !can_tear(w, vertex, &ring, &r))
      continue;
    best->vertex = vertex;
    best->ratio = r;
  }
  w->work.tear_candidates += separation_end(&f) - separation_first(&f);
}

/* 1 iff a line through the vertex may exceed its required strength, and the best line. */
static int may_exceed(const fray_world *w, uint32_t vertex, int32_t min_strength, const tear *best) {
  const int64_t bound =
      separation_bound(w->membrane.max_stress[vertex].x, !trimesh_is_boundary(&w->trimesh, vertex));
  if (bound <= min_strength) return 0;
  return best->vertex == TRIMESH_NONE ||
         bound * best->ratio.required > fx_mul_wide(best->ratio.separation, min_strength);
}

static void split_at(fray_world *w, const tear *best, const tear_strength *strength, int32_t *cooldown) {
  FRAY_ASSERT(best->vertex >= particles_attached(w) && best->vertex < w->p.count);
  FRAY_ASSERT(best->ratio.separation > best->ratio.required);
  trimesh_ring ring;
  trimesh_ring_of(&w->trimesh, best->vertex, &ring);
  const trimesh_ray from = ray_of(best->ratio.candidate);
  const trimesh_ray to = opposite_of(&w->trimesh, &ring, best->vertex, &best->ratio);
  const trimesh_result result = trimesh_split(w, best->vertex, &from, &to, TRIMESH_TORN);
  if (result == TRIMESH_NO_PARTICLES) world_fault(w, FRAY_FAULT_PARTICLES_FULL);
  if (result == TRIMESH_NO_TRIANGLES) world_fault(w, FRAY_FAULT_TRIANGLES_FULL);
  if (result != TRIMESH_DONE) return;
  if (w->work.tears == 0) w->first_tear = best->vertex;
  ++w->work.tears;
  world_count_tears(w, 1);
  *cooldown = strength->cooldown;
}

static void tear_material(fray_world *w, uint32_t material) {
  FRAY_ASSERT(material < (uint32_t)w->trimesh.params->materials);
  const trimesh *s = &w->trimesh;
  const tear_strength *strength = &w->membrane.tear_strengths[material];
  const int32_t min_strength = tear_strength_min(strength);
  int32_t *cooldown = &w->trimesh.state->tear_cooldown[material];
  tear best = {TRIMESH_NONE, {0, 1, 0, 0, {0, 0}}};
  if (min_strength == 0) return;
  if (*cooldown > 0) {
    --*cooldown;
    return;
  }
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p)
    if (s->material[s->first_triangle[p]] == material && may_exceed(w, p, min_strength, &best))
      test_vertex(w, p, strength, &best);
  if (best.vertex != TRIMESH_NONE) split_at(w, &best, strength, cooldown);
}

void membrane_tear_apply(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w) && w->params->tearing != 0);
  find_max_stress(w);
  for (uint32_t material = 0; material < (uint32_t)w->trimesh.params->materials; ++material)
    tear_material(w, material);
  w->work.tear_tests += triangles_in_use(w);
}
