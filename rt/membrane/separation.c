/* SPDX-License-Identifier: Apache-2.0 */
/* separation.h has the method and its formats. */
#include "rt/membrane/separation.h"

#include "rt/state/material.h"

static separation_direction unit(int32_t x, int32_t y) {
  const uint64_t squared = fx_square(x) + fx_square(y);
  separation_direction d = {0, 0};
  if (squared == 0) return d;
  const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
  d.u = fx_root_unit(root, x);
  d.v = fx_root_unit(root, y);
  return d;
}

typedef struct {
  int64_t u, v;
} traction;

/* The integral of a stress times direction, from one direction to another, anticlockwise. */
static traction traction_between(sym2 stress, separation_direction from, separation_direction to) {
  const int32_t du = fx_sub(to.v, from.v);
  const int32_t dv = fx_sub(from.u, to.u);
  const traction q = {fx_add64(fx_mul_wide(stress.xx, du), fx_mul_wide(stress.xy, dv)),
                      fx_add64(fx_mul_wide(stress.xy, du), fx_mul_wide(stress.yy, dv))};
  return q;
}

static sym2 clamp_stress(sym2 m) {
  const int32_t max = SEPARATION_STRESS_MAX;
  const sym2 clamped = {fx_clamp(m.xx, -max, max), fx_clamp(m.yy, -max, max), fx_clamp(m.xy, -max, max)};
  return clamped;
}

void separation_prepare(separation_ring *ring) {
  FRAY_ASSERT(ring->count >= 1 && ring->count <= TRIMESH_RING_MAX && ring->closed <= 1);
  if (ring->closed != 0) ring->edge[ring->count] = ring->edge[0];
  ring->major = 0;
  ring->traction_u[0] = 0;
  ring->traction_v[0] = 0;
  for (uint32_t n = 0; n < ring->count; ++n) {
    const sym2 m = clamp_stress(ring->stress[n]);
    ring->middle[n] = unit(fx_add(ring->edge[n].u, ring->edge[n + 1u].u),
                           fx_add(ring->edge[n].v, ring->edge[n + 1u].v));
    ring->edge[n] = unit(ring->edge[n].u, ring->edge[n].v);
    ring->major = fx_max(ring->major, sym2_eigen_of(m).major);
    ring->stress[n] = sym2_positive(m);
  }
  ring->edge[ring->count] =
      ring->closed != 0 ? ring->edge[0] : unit(ring->edge[ring->count].u, ring->edge[ring->count].v);
  for (uint32_t n = 0; n < ring->count; ++n) {
    const traction q = traction_between(ring->stress[n], ring->edge[n], ring->edge[n + 1u]);
    ring->traction_u[n + 1u] = fx_add64(ring->traction_u[n], q.u);
    ring->traction_v[n + 1u] = fx_add64(ring->traction_v[n], q.v);
  }
}

/* Traction from edge 0 to a direction in triangle n. */
static traction traction_up_to(const separation_ring *ring, uint32_t n, separation_direction d) {
  traction q = traction_between(ring->stress[n], ring->edge[n], d);
  q.u = fx_add64(q.u, ring->traction_u[n]);
  q.v = fx_add64(q.v, ring->traction_v[n]);
  return q;
}

static int64_t cross(separation_direction from, separation_direction to) {
  return fx_mul_wide(from.u, to.v) - fx_mul_wide(from.v, to.u);
}

/* The triangle of a closed ring that a direction is in: the one whose ring edges are on both sides of it;
 * where rounding leaves none, the one that comes nearest to that. */
static uint32_t triangle_at(const separation_ring *ring, separation_direction d) {
  uint32_t found = 0;
  int64_t best = INT64_MIN;
  for (uint32_t n = 0; n < ring->count; ++n) {
    const int64_t after = cross(ring->edge[n], d);
    const int64_t ahead = cross(d, ring->edge[n + 1u]);
    if (after >= 0 && ahead > 0) return n;
    const int64_t smaller = after < ahead ? after : ahead;
    if (smaller <= best) continue;
    best = smaller;
    found = n;
  }
  return found;
}

static int32_t dot(separation_direction a, separation_direction b) {
  return (int32_t)fx_round64(fx_add64(fx_mul_wide(a.u, b.u), fx_mul_wide(a.v, b.v)), 30);
}

static separation_direction round_traction(traction q) {
  const separation_direction d = {(int32_t)fx_round64(q.u, 30), (int32_t)fx_round64(q.v, 30)};
  return d;
}

typedef struct {
  int32_t separation;
  uint32_t opposite;
  separation_direction line;
} separated_line;

static separated_line separation_along(const separation_ring *ring, uint32_t candidate) {
  FRAY_ASSERT(candidate >= separation_first(ring) && candidate < separation_end(ring));
  const uint32_t n = candidate / 2u;
  const traction all = {ring->traction_u[ring->count], ring->traction_v[ring->count]};
  separated_line line = {0, 0, candidate % 2u == 0 ? ring->edge[n] : ring->middle[n]};
  const traction here = traction_up_to(ring, n, line.line);
  traction left = {all.u - here.u, all.v - here.v};
  if (ring->closed != 0) {
    const separation_direction back = {-line.line.u, -line.line.v};
    line.opposite = triangle_at(ring, back);
    const traction there = traction_up_to(ring, line.opposite, back);
    left.u = there.u - here.u;
    left.v = there.v - here.v;
    if (line.opposite < n) {
      left.u += all.u;
      left.v += all.v;
    }
  }
  const traction right = {all.u - left.u, all.v - left.v};
  const separation_direction q1 = round_traction(left);
  const separation_direction q2 = round_traction(right);
  const separation_direction q = unit(fx_sub(q1.u, q2.u), fx_sub(q1.v, q2.v));
  line.separation = fx_max(0, fx_min(dot(q1, q), -dot(q2, q)));
  return line;
}

static int32_t strength_required(const int32_t strength[SEPARATION_STRENGTHS], separation_direction line) {
  const int flip = line.u < 0 || (line.u == 0 && line.v < 0);
  const int32_t u = flip ? -line.u : line.u;
  const int32_t v = flip ? -line.v : line.v;
  const int32_t at = material_direction(v, u); /* 1 is 45 degrees */
  const uint32_t row = (uint32_t)fx_asr(at, STRAIN_BITS) % SEPARATION_STRENGTHS;
  const int32_t fraction = at & (STRAIN_ONE - 1);
  const int32_t from = strength[row];
  const int32_t to = strength[(row + 1u) % SEPARATION_STRENGTHS];
  return from + fx_mul_round(fx_sub(to, from), fraction, STRAIN_BITS);
}

separation_ratio separation_ratio_of(const separation_ring *ring, uint32_t candidate,
                                     const int32_t strength[SEPARATION_STRENGTHS]) {
  const separated_line line = separation_along(ring, candidate);
  const int32_t required = strength_required(strength, line.line);
  FRAY_ASSERT(required > 0);
  const separation_ratio ratio = {line.separation, ring->closed != 0 ? fx_add(required, required) : required,
                                  candidate, line.opposite, line.line};
  return ratio;
}
