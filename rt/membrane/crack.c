/* SPDX-License-Identifier: Apache-2.0 */
/* Cracks of an isotropic sheet, once a tick: by the largest principal stress, averaged over a length of
 * the material (stress_average.h), where it is above `breaks`.
 *
 *   a crack begins  where it is largest, across it: to both sides of a vertex inside; or, if there is one
 *                   within that length, inward from the vertex on the boundary whose edges have most to let
 *                   go. While a crack has a tip only where `many` says so, farther than that length from all
 *   a tip goes on   by an edge a tick, across its own stress, forward (trimesh_advance.h); it ends where it
 *                   meets a boundary. Where none may begin, the stress around tips is all that is found
 *
 * (Haptic tearing of 2017, section V: the eigenvector of the largest eigenvalue, then the tip alone.) After a
 * crack none goes on for `cooldown` ticks, in which the stress finds its new balance. */
#include "rt/membrane/membrane.h"
#include "rt/membrane/snap_balance.h"
#include "rt/membrane/stress_average.h"
#include "rt/trimesh/trimesh_advance.h"

#if FRAY_CRACKS

/* A direction of rest coordinates, Q30. */
typedef struct {
  int32_t u, v;
} crack_way;

typedef struct {
  int32_t stress; /* Q12 N/m */
  crack_way across;
} crack_load;

/* Cosine and sine of half the angle, turned by a right angle. */
static crack_way across_major(const sym2_eigen *e) {
  const uint64_t one = (uint64_t)1 << 30;
  const int is_wide = e->cosine < 0; /* more than 45 degrees: the sine is the greater */
  const uint64_t square = (one + fx_magnitude(e->cosine)) << 29;
  const fx_root root = fx_rsqrt(square, FX_ROOT_FINE);
  const int32_t greater = (int32_t)fx_root_length(root);
  const int32_t lesser = (int32_t)fx_root_over(root, e->sine, 29);
  const crack_way steep = {-greater, lesser};
  const crack_way flat = {-lesser, greater};
  return is_wide ? steep : flat;
}

static crack_load load_at(fray_world *w, uint32_t vertex) {
  const sym2_eigen e = sym2_eigen_of(stress_average(w, vertex, w->membrane.crack_constants->average));
  const crack_load load = {e.major, across_major(&e)};
  ++w->work.eigenvalues;
  return load;
}

static int64_t dot_of(crack_way a, crack_way b) { return fx_mul_wide(a.u, b.u) + fx_mul_wide(a.v, b.v); }
static crack_way reversed(crack_way a) {
  const crack_way back = {-a.u, -a.v};
  return back;
}
static crack_way forward_of(crack_way across, crack_way way) {
  return dot_of(across, way) < 0 ? reversed(across) : across;
}

/* ---- tips ---- */

static void count_step(fray_world *w, uint32_t vertex) {
  if (w->work.tears == 0) w->first_tear = vertex;
  ++w->work.tears;
  world_count_tears(w, 1);
}

static trimesh_result open_path(fray_world *w, const trimesh_path *path, trimesh_step *step) {
  const uint32_t nearer = trimesh_path_nearer(path);
  trimesh_snap snap;
  snap_parting parting;
  for (uint32_t n = 0; n < 2; ++n) {
    if (!trimesh_path_snap(w, path, n == 0 ? nearer : 1u - nearer, &snap) ||
        !snap_balance(w, path, &snap, &parting))
      continue;
    const trimesh_result result = trimesh_path_open(w, path, &snap, TRIMESH_TORN, step);
    if (result == TRIMESH_DONE && path->ring.closed == 0)
      snap_part(w, path->vertex, w->p.count - 1u, &parting);
    return result;
  }
  return trimesh_path_open(w, path, NULL, TRIMESH_TORN, step);
}

/* What a crack makes keeps half of its stiffness, or more (membrane_gains.c): slivers that keep less are
 * drawn to several times their length by what their neighbours carry. */
static uint32_t norm2_most(const fray_world *w) {
  return (uint32_t)fx_clamp64(fx_mul_wide(w->membrane.constants->norm2_max, 7) / 5, 0, UINT32_MAX);
}

static trimesh_result open_way(fray_world *w, uint32_t vertex, crack_way way, trimesh_step *step) {
  trimesh_path path;
  trimesh_result result = trimesh_path_find(w, vertex, way.u, way.v, norm2_most(w), &path);
  if (result == TRIMESH_DONE) result = open_path(w, &path, step);
  if (result == TRIMESH_NO_PARTICLES) world_fault(w, FRAY_FAULT_PARTICLES_FULL);
  if (result == TRIMESH_NO_TRIANGLES) world_fault(w, FRAY_FAULT_TRIANGLES_FULL);
  if (result == TRIMESH_DONE) count_step(w, vertex);
  return result;
}

static void remove_tip(crack_state *c, uint32_t n) {
  static const crack_tip none = {0, 0, 0};
  for (--c->tips; n < (uint32_t)c->tips; ++n) c->tip[n] = c->tip[n + 1u];
  c->tip[c->tips] = none;
}

/* Where a crack has met a boundary there is no tip any more. */
static void remove_tips_at(crack_state *c, uint32_t vertex) {
  for (uint32_t n = (uint32_t)c->tips; n > 0; --n)
    if ((uint32_t)c->tip[n - 1u].vertex == vertex) remove_tip(c, n - 1u);
}

/* The way that an edge has gone, at rest; edges are below 2^30. */
static crack_way way_between(const trimesh *s, uint32_t from, uint32_t to) {
  const int32_t u = fx_sub(s->u[to], s->u[from]);
  const int32_t v = fx_sub(s->v[to], s->v[from]);
  const fx_root root = fx_rsqrt(fx_square(u) + fx_square(v), FX_ROOT_FINE);
  const crack_way way = {fx_root_unit(root, u), fx_root_unit(root, v)};
  return way;
}

/* Returns 1 iff the tip is no more. */
static int advance_tip(fray_world *w, uint32_t n, uint32_t *met) {
  crack_tip *tip = &w->membrane.cracks->tip[n];
  const crack_way came = {tip->way_u, tip->way_v};
  const uint32_t vertex = (uint32_t)tip->vertex;
  trimesh_step step;
  const crack_load load = load_at(w, vertex);
  *met = TRIMESH_NONE;
  if (load.stress <= w->membrane.crack_constants->breaks ||
      open_way(w, vertex, forward_of(load.across, came), &step) != TRIMESH_DONE)
    return 0;
  const crack_way way = way_between(&w->trimesh, vertex, step.end);
  tip->vertex = (int32_t)step.end;
  tip->way_u = way.u;
  tip->way_v = way.v;
  if (step.end_was_boundary) *met = step.end;
  return step.end_was_boundary;
}

static void advance_tips(fray_world *w) {
  crack_state *c = w->membrane.cracks;
  uint32_t n = 0;
  for (uint32_t left = (uint32_t)c->tips; left > 0 && n < (uint32_t)c->tips; --left) {
    uint32_t met;
    if (advance_tip(w, n, &met))
      remove_tips_at(c, met);
    else
      ++n;
  }
}

/* ---- where a crack begins ---- */

/* No less than the largest principal stress. */
static int is_loaded(material_tensor s, int32_t breaks) {
  return (int64_t)fx_max(s.uu, s.vv) + fx_magnitude(s.uv) > breaks;
}

/* Vertices of triangles that are loaded, in `x` of the impulse sums; returns 0 iff there are none. */
static int mark_loaded(fray_world *w) {
  elastic_impulse *const marks = w->membrane.max_stress;
  int any = 0;
  for (uint32_t p = 0; p < w->p.count; ++p) marks[p].x = 0;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) {
    if (!is_loaded(w->membrane.stress[t], w->membrane.crack_constants->breaks)) continue;
    any = 1;
    for (uint32_t k = 0; k < 3; ++k) marks[w->trimesh.triangle[t].v[k]].x = 1;
  }
  return any;
}

static uint64_t edge_squared(const trimesh *s, uint32_t a, uint32_t b) {
  return fx_square(fx_sub(s->u[a], s->u[b])) + fx_square(fx_sub(s->v[a], s->v[b]));
}

/* Within the length of the average. */
static int are_near(const fray_world *w, uint32_t a, uint32_t b) {
  return edge_squared(&w->trimesh, a, b) <= fx_square(w->membrane.crack_constants->average);
}

static int is_far_from_tips(const fray_world *w, uint32_t vertex) {
  const crack_state *c = w->membrane.cracks;
  for (uint32_t n = 0; n < (uint32_t)c->tips; ++n)
    if (are_near(w, (uint32_t)c->tip[n].vertex, vertex)) return 0;
  return 1;
}

/* The tension that the best edge from a vertex on the boundary would let go, Q10 N/m: what the triangles on
 * one side of it pull with, over its length. A triangle pulls its corner with stress times half the opposite
 * edge, turned by a right angle. */
static uint32_t pull_of_ring(const fray_world *w, uint32_t vertex) {
  const trimesh *s = &w->trimesh;
  trimesh_ring ring;
  int64_t sum[2] = {0, 0};
  uint32_t most = 0;
  trimesh_ring_of(s, vertex, &ring);
  for (uint32_t n = 0; n + 1u < ring.count; ++n) {
    const material_tensor *stress = &w->membrane.stress[ring.triangle[n]];
    const uint32_t from = trimesh_ring_end(s, &ring, n);
    const uint32_t to = trimesh_ring_end(s, &ring, n + 1u);
    const int32_t u = fx_sub(s->u[to], s->u[from]);
    const int32_t v = fx_sub(s->v[to], s->v[from]);
    const int32_t shear = stress_average_held(stress->uv);
    const int32_t uu = stress_average_held(stress->uu);
    const int32_t vv = stress_average_held(stress->vv);
    sum[0] = fx_add64(sum[0], fx_mul_wide(uu, v) - fx_mul_wide(shear, u));
    sum[1] = fx_add64(sum[1], fx_mul_wide(shear, v) - fx_mul_wide(vv, u));
    const int32_t pull_u = fx_saturate(fx_round64(sum[0], 16)) / 2; /* Q20 N/m lu */
    const int32_t pull_v = fx_saturate(fx_round64(sum[1], 16)) / 2;
    const uint64_t squared = fx_square(pull_u) + fx_square(pull_v);
    if (squared == 0) continue;
    const uint64_t pull = fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
    const uint64_t length = edge_squared(s, vertex, to);
    const uint32_t tension = fx_divide_wide(pull << 14, fx_root_length(fx_rsqrt(length, FX_ROOT_FINE)));
    if (tension > most) most = tension;
  }
  return most;
}

/* Into the sheet, from a vertex on the boundary: halfway between the two edges there. */
static crack_way inward_of(const trimesh *s, uint32_t vertex) {
  trimesh_ring ring;
  trimesh_ring_of(s, vertex, &ring);
  const crack_way a = way_between(s, vertex, trimesh_ring_end(s, &ring, 0));
  const crack_way b = way_between(s, vertex, trimesh_ring_end(s, &ring, ring.count));
  const int is_narrow = fx_mul_wide(a.u, b.v) - fx_mul_wide(a.v, b.u) > 0; /* below 180 degrees */
  const int64_t u = -(int64_t)a.v + b.v + (is_narrow ? 1 : -1) * ((int64_t)a.u + b.u);
  const int64_t v = (int64_t)a.u - b.u + (is_narrow ? 1 : -1) * ((int64_t)a.v + b.v);
  const crack_way inward = {(int32_t)fx_asr64(u, 2), (int32_t)fx_asr64(v, 2)};
  return inward;
}

static void begin_one(fray_world *w, uint32_t vertex, crack_way way) {
  crack_state *c = w->membrane.cracks;
  trimesh_step step;
  if (open_way(w, vertex, way, &step) != TRIMESH_DONE) return;
  if (step.end_was_boundary) {
    remove_tips_at(c, step.end);
    return;
  }
  const crack_way came = way_between(&w->trimesh, vertex, step.end);
  const crack_tip tip = {(int32_t)step.end, came.u, came.v};
  c->tip[c->tips++] = tip;
}

static void begin_at(fray_world *w, uint32_t vertex) {
  const crack_way across = load_at(w, vertex).across;
  FRAY_ASSERT(w->membrane.cracks->tips + 2 <= CRACK_TIPS);
  if (trimesh_is_boundary(&w->trimesh, vertex)) {
    begin_one(w, vertex, forward_of(across, inward_of(&w->trimesh, vertex)));
  } else {
    begin_one(w, vertex, across);
    begin_one(w, vertex, reversed(across));
  }
}

/* The average is less at the end of a notch, whose sides bear nothing, than before it. */
static uint32_t boundary_near(fray_world *w, uint32_t vertex) {
  uint32_t best = vertex;
  uint32_t largest = 0;
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    if (w->membrane.max_stress[p].x == 0 || !trimesh_is_boundary(&w->trimesh, p) || !are_near(w, p, vertex) ||
        !is_far_from_tips(w, p))
      continue;
    const uint32_t pull = pull_of_ring(w, p);
    if (pull <= largest) continue;
    best = p;
    largest = pull;
  }
  return best;
}

static void begin_crack(fray_world *w) {
  uint32_t best = TRIMESH_NONE;
  int32_t largest = w->membrane.crack_constants->breaks;
  if (w->membrane.cracks->tips + 2 > CRACK_TIPS || !mark_loaded(w)) return;
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    if (w->membrane.max_stress[p].x == 0 || !is_far_from_tips(w, p)) continue;
    const int32_t stress = load_at(w, p).stress;
    if (stress <= largest) continue;
    best = p;
    largest = stress;
  }
  if (best != TRIMESH_NONE) begin_at(w, boundary_near(w, best));
}

void crack_advance(fray_world *w) {
  FRAY_ASSERT(world_has_cracks(w));
  const crack_state *c = w->membrane.cracks;
  int32_t *cooldown = &w->trimesh.state->tear_cooldown[0];
  const uint32_t before = w->work.tears;
  const int may_begin = c->tips == 0 || w->membrane.crack_constants->many != 0;
  w->work.tear_tests += triangles_in_use(w);
  if (*cooldown > 0) {
    --*cooldown;
    return;
  }
  if (may_begin) membrane_stress_update(w);
  stress_average_begin(w, may_begin);
  advance_tips(w);
  if (may_begin) begin_crack(w);
  if (w->work.tears != before) *cooldown = w->membrane.tear_strengths[0].cooldown;
}

#endif
