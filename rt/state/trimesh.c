/* SPDX-License-Identifier: Apache-2.0 */
/* The one-ring, quality, weights and hash entries of the trimesh; trimesh.h has its formats. */
#include "rt/state/trimesh.h"

#include "rt/base/hash.h"
#include "rt/state/world.h"

void trimesh_ring_of(const trimesh *s, uint32_t vertex, trimesh_ring *ring) {
  const uint32_t first = s->first_triangle[vertex];
  uint32_t t = first;
  FRAY_ASSERT(first < (uint32_t)s->state->triangles && trimesh_corner(s, first, vertex) < 3);
  ring->count = 0;
  ring->closed = 0;
  while (ring->count < TRIMESH_RING_MAX) {
    const uint32_t k = trimesh_corner(s, t, vertex);
    FRAY_ASSERT(k < 3);
    ring->triangle[ring->count] = t;
    ring->corner[ring->count++] = (uint8_t)k;
    const uint32_t next = trimesh_neighbour(s, t, trimesh_next(k));
    if (next == TRIMESH_NONE) return;
    FRAY_ASSERT(s->triangle[next].neighbour[trimesh_neighbour_edge(s, t, trimesh_next(k))] == t);
    if (next == first) {
      ring->closed = 1;
      return;
    }
    t = next;
  }
}

int64_t trimesh_twice_area(trimesh_point a, trimesh_point b, trimesh_point c) {
  return fx_add64(fx_mul_wide(fx_sub(b.u, a.u), fx_sub(c.v, a.v)),
                  -fx_mul_wide(fx_sub(b.v, a.v), fx_sub(c.u, a.u)));
}

static uint64_t edge_squared(trimesh_point a, trimesh_point b) {
  return fx_square(fx_sub(b.u, a.u)) + fx_square(fx_sub(b.v, a.v));
}

/* The smallest height is the one on the longest edge. */
int trimesh_exceeds_quality(const trimesh *s, uint32_t by, trimesh_point a, trimesh_point b,
                            trimesh_point c) {
  FRAY_ASSERT(by <= 1);
  const int64_t twice = trimesh_twice_area(a, b, c);
  if (twice < (int64_t)s->params->area_min * (1 << (19 + 2 * by))) return 0;
  const uint64_t squares[3] = {edge_squared(a, b), edge_squared(b, c), edge_squared(c, a)};
  uint64_t longest = squares[0] > squares[1] ? squares[0] : squares[1];
  if (squares[2] > longest) longest = squares[2];
  const uint32_t length = fx_root_length(fx_rsqrt(longest, FX_ROOT_FINE));
  return twice >= fx_mul_wide(s->params->height_min, (int32_t)length) * (1 << by);
}

/* n * 2^46 / twice, for results below 2^31. */
static int32_t over_twice_area(int32_t n, int64_t twice) {
  FRAY_ASSERT(twice > 0);
  const unsigned up = fx_leading_zeros64((uint64_t)twice);
  const uint32_t divisor = (uint32_t)((uint64_t)twice << up >> 33);
  const unsigned shift = 13u + up; /* 46 - (33 - up) */
  const uint64_t whole = ((uint64_t)fx_magnitude(n) << shift) + divisor / 2u;
  const uint32_t quotient = fx_divide_wide(whole, divisor);
  return n < 0 ? -(int32_t)quotient : (int32_t)quotient;
}

trimesh_weights trimesh_weights_between(trimesh_point a, trimesh_point b, trimesh_point c) {
  const int64_t twice = trimesh_twice_area(a, b, c);
  FRAY_ASSERT(twice > 0);
  const trimesh_weights w = {
      over_twice_area(fx_sub(c.v, a.v), twice), over_twice_area(fx_sub(a.v, b.v), twice),
      over_twice_area(fx_sub(a.u, c.u), twice), over_twice_area(fx_sub(b.u, a.u), twice)};
  return w;
}

void trimesh_derive(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w) && triangles_in_use(w) <= w->capacity[POOL_TRIANGLES]);
  const trimesh *s = &w->trimesh;
  for (uint32_t p = 0; p < w->capacity[POOL_PARTICLES]; ++p) s->mass[p] = 0;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    for (uint32_t k = 0; k < 3; ++k) s->mass[s->triangle[t].v[k]] += s->area[t];
    s->weights[t] = trimesh_weights_of(s, t);
    w->membrane.bend_shapes[t] = bend_shape_of(s, t);
  }
  w->membrane.bend_current = 0;
}

uint64_t trimesh_triangle_entry(const trimesh *s, uint32_t t) {
  uint64_t total = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    total ^= hash_entry(TOPOLOGY_TRIANGLE, 8u * t + k, s->triangle[t].v[k]);
    total ^= hash_entry(TOPOLOGY_TRIANGLE, 8u * t + 3u + k, s->triangle[t].neighbour[k]);
  }
  total ^= hash_entry(TOPOLOGY_TRIANGLE, 8u * t + 6u, s->area[t]);
  return total ^ hash_entry(TOPOLOGY_TRIANGLE, 8u * t + 7u,
                            (uint32_t)s->edge_marks[t] << 8 | s->material[t]);
}

uint64_t trimesh_vertex_entry(const trimesh *s, uint32_t p) {
  return hash_entry(TOPOLOGY_VERTEX, 4u * p, (uint32_t)s->u[p]) ^
         hash_entry(TOPOLOGY_VERTEX, 4u * p + 1u, (uint32_t)s->v[p]) ^
         hash_entry(TOPOLOGY_VERTEX, 4u * p + 2u, s->first_triangle[p]);
}

uint64_t trimesh_topology(const fray_world *w) {
  const trimesh *s = &w->trimesh;
  uint64_t total = 0;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) total ^= trimesh_triangle_entry(s, t);
  for (uint32_t p = 0; p < w->p.count; ++p)
    if (s->mass[p] != 0) total ^= trimesh_vertex_entry(s, p);
  return total;
}
