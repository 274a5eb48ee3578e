/* SPDX-License-Identifier: Apache-2.0 */
/* trimesh_advance.h has the contract. */
#include "rt/trimesh/trimesh_advance.h"

#if FRAY_CRACKS

enum {
  BESIDE = TRIMESH_WEIGHT_ONE / 128,  /* half a degree: an edge that is there is the path */
  FARTHEST = TRIMESH_WEIGHT_ONE / 5 * 3 /* of the way along an edge that a vertex moves */
};

/* Between the ends of ring edges n and n + 1. */
typedef struct {
  trimesh_ring ring;
  trimesh_point centre;
  uint32_t n, fraction;
  uint32_t end[2];
  int can_open[2];
} advance_plan;

static int can_open_to(const fray_world *w, const trimesh_ring *ring, uint32_t n) {
  const uint32_t end = trimesh_ring_end(&w->trimesh, ring, n);
  if (ring->closed == 0 && (n == 0 || n >= ring->count)) return 0;
  return !(particle_is_attached(w, end) && trimesh_is_boundary(&w->trimesh, end));
}

static int plan_advance(const fray_world *w, uint32_t vertex, int32_t du, int32_t dv, advance_plan *p) {
  const trimesh *s = &w->trimesh;
  trimesh_ray ray;
  trimesh_ring_of(s, vertex, &p->ring);
  p->centre = trimesh_at(s, vertex);
  if (particle_is_attached(w, vertex) || !trimesh_ray_along(s, &p->ring, p->centre, du, dv, &ray)) return 0;
  p->n = ray.n;
  p->fraction = ray.fraction;
  for (uint32_t m = 0; m < 2; ++m) {
    p->end[m] = trimesh_ring_end(s, &p->ring, ray.n + m);
    p->can_open[m] = can_open_to(w, &p->ring, ray.n + m);
  }
  return 1;
}

/* Of a triangle that is divided from corner k to a point of the opposite edge. */
static int parts_are_stout(const trimesh *s, uint32_t t, uint32_t k, trimesh_point at) {
  const trimesh_point apex = trimesh_at(s, s->triangle[t].v[k]);
  return trimesh_is_stout(s, apex, trimesh_at(s, s->triangle[t].v[trimesh_next(k)]), at) &&
         trimesh_is_stout(s, apex, at, trimesh_at(s, s->triangle[t].v[trimesh_previous(k)]));
}

static int divides_stoutly(const fray_world *w, const advance_plan *p) {
  const trimesh *s = &w->trimesh;
  const uint32_t t = p->ring.triangle[p->n];
  const uint32_t k = p->ring.corner[p->n];
  const uint32_t other = trimesh_neighbour(s, t, k);
  const trimesh_point at =
      trimesh_point_on(trimesh_at(s, p->end[0]), trimesh_at(s, p->end[1]), p->fraction);
  return trimesh_can_divide_edge(s, t, k, p->fraction) && parts_are_stout(s, t, k, at) &&
         (other == TRIMESH_NONE || parts_are_stout(s, other, trimesh_neighbour_edge(s, t, k), at));
}

/* Moves end m onto the path. */
static int snap_end(fray_world *w, const advance_plan *p, uint32_t m) {
  const uint32_t fraction = m == 0 ? p->fraction : TRIMESH_WEIGHT_ONE - p->fraction;
  return fraction <= FARTHEST && p->can_open[m] &&
         trimesh_snap(w, p->end[m], p->end[1u - m], fraction) == TRIMESH_DONE;
}

/* Brings a vertex onto the path, or takes one beside it: TRIMESH_NONE, where there is none. */
static uint32_t vertex_ahead(fray_world *w, const advance_plan *p, trimesh_way *way) {
  const uint32_t nearer = p->fraction < TRIMESH_WEIGHT_ONE / 2 ? 0 : 1;
  uint32_t added = TRIMESH_NONE;
  *way = TRIMESH_ALONG;
  if (p->fraction <= BESIDE && p->can_open[0]) return p->end[0];
  if (p->fraction >= TRIMESH_WEIGHT_ONE - BESIDE && p->can_open[1]) return p->end[1];
  for (uint32_t n = 0; n < 2; ++n) {
    const uint32_t m = n == 0 ? nearer : 1u - nearer;
    if (!snap_end(w, p, m)) continue;
    *way = TRIMESH_SNAPPED;
    return p->end[m];
  }
  if (divides_stoutly(w, p) && trimesh_divide_edge(w, p->ring.triangle[p->n], p->ring.corner[p->n],
                                                    p->fraction, &added) == TRIMESH_DONE) {
    *way = TRIMESH_DIVIDED;
    return added;
  }
  if (p->can_open[nearer]) return p->end[nearer];
  return p->can_open[1u - nearer] ? p->end[1u - nearer] : TRIMESH_NONE;
}

trimesh_result trimesh_advance(fray_world *w, uint32_t vertex, int32_t du, int32_t dv, trimesh_mark mark,
                               trimesh_step *step) {
  enum { PARTICLES = 3, TRIANGLES = 2 }; /* that a step takes at most */
  advance_plan p;
  FRAY_ASSERT(vertex < w->p.count);
  if (!plan_advance(w, vertex, du, dv, &p)) return TRIMESH_NO_PATH;
  if (w->capacity[POOL_PARTICLES] - w->p.count < PARTICLES) return TRIMESH_NO_PARTICLES;
  if (w->capacity[POOL_TRIANGLES] - triangles_in_use(w) < TRIANGLES) return TRIMESH_NO_TRIANGLES;
  step->end = vertex_ahead(w, &p, &step->way);
  if (step->end == TRIMESH_NONE) return TRIMESH_NO_PATH;
  step->end_was_boundary = trimesh_is_boundary(&w->trimesh, step->end);
  return trimesh_open_to(w, vertex, step->end, mark);
}

#endif
