/* SPDX-License-Identifier: Apache-2.0 */
/* stress_average.h has the contract. Triangles are found across edges: none beyond a crack counts.
 *
 *   middle     sum of the corners, from three times the vertex, Q24 lu: its square is r^2 of 3 radius
 *   weight     Q30 lu^2, below 2^27
 *   sums       stress times weight, of 256: below 2^61 */
#include "rt/membrane/stress_average.h"

#include "rt/membrane/membrane.h"

#if FRAY_CRACKS

typedef struct {
  fray_world *w;
  trimesh_point centre;
  uint64_t reach;  /* the square of 3 radius */
  unsigned shift;  /* so that it fits 31 bits */
  uint32_t mark, count;
  index_t found[STRESS_AVERAGE_TRIANGLES];
} average_search;

enum {
  STRESS_UNKNOWN = 0,
  STRESS_KNOWN = 1, /* in no average yet */
  STRESS_GROUP = 16 /* found at a time, since kernels take neighbours by number */
};

void stress_average_begin(fray_world *w, int is_known) {
  FRAY_ASSERT(world_has_cracks(w));
  w->membrane.averages = STRESS_KNOWN;
  for (uint32_t t = 0; t < w->capacity[POOL_TRIANGLES]; ++t)
    w->membrane.averaged[t] = is_known ? STRESS_KNOWN : STRESS_UNKNOWN;
}

/* The square of the way from the vertex, of three times its length. */
static uint64_t distance_of(const average_search *a, uint32_t t) {
  const trimesh *s = &a->w->trimesh;
  const index_t *v = s->triangle[t].v;
  const int64_t u = (int64_t)s->u[v[0]] + s->u[v[1]] + s->u[v[2]] - 3 * (int64_t)a->centre.u;
  const int64_t w = (int64_t)s->v[v[0]] + s->v[v[1]] + s->v[v[2]] - 3 * (int64_t)a->centre.v;
  return fx_square(fx_saturate(u)) + fx_square(fx_saturate(w));
}

static void find_stress(fray_world *w, uint32_t t) {
  const uint32_t triangles = triangles_in_use(w);
  const uint32_t first = t - t % STRESS_GROUP;
  const uint32_t end = triangles - first > STRESS_GROUP ? first + STRESS_GROUP : triangles;
  membrane_stress_find(w, first, end);
  for (uint32_t n = first; n < end; ++n)
    if (w->membrane.averaged[n] == STRESS_UNKNOWN) w->membrane.averaged[n] = STRESS_KNOWN;
}

static int is_found(const average_search *a, uint32_t t) { return a->w->membrane.averaged[t] == a->mark; }

static void find(average_search *a, uint32_t t) {
  if (a->count == STRESS_AVERAGE_TRIANGLES || is_found(a, t)) return;
  if (a->w->membrane.averaged[t] == STRESS_UNKNOWN) find_stress(a->w, t);
  a->w->membrane.averaged[t] = a->mark;
  a->found[a->count++] = (index_t)t;
}

static void find_around(average_search *a, uint32_t vertex) {
  const trimesh *s = &a->w->trimesh;
  trimesh_ring ring;
  trimesh_ring_of(s, vertex, &ring);
  for (uint32_t n = 0; n < ring.count; ++n) find(a, ring.triangle[n]);
  for (uint32_t n = 0; n < a->count; ++n)
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t other = trimesh_neighbour(s, a->found[n], k);
      if (other != TRIMESH_NONE && !is_found(a, other) && distance_of(a, other) < a->reach) find(a, other);
    }
}

static int32_t mean_stress(int64_t sum, uint64_t weight) {
  unsigned shift = 0;
  while (weight >> shift >= (uint64_t)1 << 31) ++shift;
  const uint64_t size = sum < 0 ? (uint64_t)-sum : (uint64_t)sum;
  const int32_t mean = (int32_t)fx_divide_wide(size >> shift, (uint32_t)(weight >> shift));
  return sum < 0 ? -mean : mean;
}

sym2 stress_average(fray_world *w, uint32_t vertex, int32_t radius) {
  average_search a = {w, trimesh_at(&w->trimesh, vertex), 9 * fx_square(radius), 0,
                      ++w->membrane.averages, 0, {0}};
  int64_t sum[3] = {0, 0, 0};
  uint64_t weights = 0;
  sym2 mean = {0, 0, 0};
  FRAY_ASSERT(radius > 0);
  while (a.reach >> a.shift >= (uint64_t)1 << 31) ++a.shift;
  find_around(&a, vertex);
  for (uint32_t n = 0; n < a.count; ++n) {
    const uint32_t t = a.found[n];
    const uint64_t distance = distance_of(&a, t);
    if (distance >= a.reach) continue;
    const uint32_t squared = fx_divide_wide(distance >> a.shift << 30, (uint32_t)(a.reach >> a.shift));
    if (squared >= 1u << 30) continue;
    const uint32_t left = (1u << 30) - squared;
    const uint64_t share = fx_mul_wide_u(left, left) >> 30;
    const int32_t weight = (int32_t)(share * w->trimesh.area[t] >> 30);
    const material_tensor *stress = &w->membrane.stress[t];
    sum[0] = fx_add64(sum[0], fx_mul_wide(stress_average_held(stress->uu), weight));
    sum[1] = fx_add64(sum[1], fx_mul_wide(stress_average_held(stress->vv), weight));
    sum[2] = fx_add64(sum[2], fx_mul_wide(stress_average_held(stress->uv), weight));
    weights += (uint32_t)weight;
  }
  if (weights == 0) return mean;
  mean.xx = mean_stress(sum[0], weights);
  mean.yy = mean_stress(sum[1], weights);
  mean.xy = mean_stress(sum[2], weights);
  return mean;
}

#endif
