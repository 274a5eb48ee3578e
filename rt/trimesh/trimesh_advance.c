/* SPDX-License-Identifier: Apache-2.0 */
/* trimesh_advance.h has the contract. */
#include "rt/trimesh/trimesh_advance.h"

#if FRAY_CRACKS

enum {
  BESIDE = TRIMESH_WEIGHT_ONE / 128,  /* half a degree: an edge that is there is the path */
  FARTHEST = TRIMESH_WEIGHT_ONE / 5 * 3 /* of the way along an edge that a vertex moves */
};

static int can_open_to(const fray_world *w, const trimesh_ring *ring, uint32_t n) {
  const uint32_t end = trimesh_ring_end(&w->trimesh, ring, n);
  if (ring->closed == 0 && (n == 0 || n >= ring->count)) return 0;
  return !(particle_is_attached(w, end) && trimesh_is_boundary(&w->trimesh, end));
}

trimesh_result trimesh_path_find(const fray_world *w, uint32_t vertex, int32_t du, int32_t dv,
                                 uint32_t norm2_most, trimesh_path *path) {
  enum { PARTICLES = 3, TRIANGLES = 2 }; /* that a step takes at most */
  const trimesh *s = &w->trimesh;
  trimesh_ray ray;
  FRAY_ASSERT(vertex < w->p.count);
  path->vertex = vertex;
  path->norm2_most = norm2_most;
  trimesh_ring_of(s, vertex, &path->ring);
  if (particle_is_attached(w, vertex) ||
      !trimesh_ray_along(s, &path->ring, trimesh_at(s, vertex), du, dv, &ray))
    return TRIMESH_NO_PATH;
  path->n = ray.n;
  path->fraction = ray.fraction;
  for (uint32_t m = 0; m < 2; ++m) {
    path->end[m] = trimesh_ring_end(s, &path->ring, ray.n + m);
    path->can_open[m] = can_open_to(w, &path->ring, ray.n + m);
  }
  if (w->capacity[POOL_PARTICLES] - w->p.count < PARTICLES) return TRIMESH_NO_PARTICLES;
  if (w->capacity[POOL_TRIANGLES] - triangles_in_use(w) < TRIANGLES) return TRIMESH_NO_TRIANGLES;
  return TRIMESH_DONE;
}

/* Of a triangle that is divided from corner k to a point of the opposite edge. */
static int parts_are_stout(const trimesh *s, uint32_t norm2_most, uint32_t t, uint32_t k,
                           trimesh_point at) {
  const trimesh_point apex = trimesh_at(s, s->triangle[t].v[k]);
  return trimesh_is_stout(s, norm2_most, apex, trimesh_at(s, s->triangle[t].v[trimesh_next(k)]), at) &&
         trimesh_is_stout(s, norm2_most, apex, at, trimesh_at(s, s->triangle[t].v[trimesh_previous(k)]));
}

static int divides_stoutly(const fray_world *w, const trimesh_path *p) {
  const trimesh *s = &w->trimesh;
  const uint32_t t = p->ring.triangle[p->n];
  const uint32_t k = p->ring.corner[p->n];
  const uint32_t other = trimesh_neighbour(s, t, k);
  const trimesh_point at =
      trimesh_point_on(trimesh_at(s, p->end[0]), trimesh_at(s, p->end[1]), p->fraction);
  return trimesh_can_divide_edge(s, t, k, p->fraction) && parts_are_stout(s, p->norm2_most, t, k, at) &&
         (other == TRIMESH_NONE ||
          parts_are_stout(s, p->norm2_most, other, trimesh_neighbour_edge(s, t, k), at));
}

/* The end where an edge is the path. */
static uint32_t end_beside(const trimesh_path *p) {
  if (p->fraction <= BESIDE && p->can_open[0]) return p->end[0];
  if (p->fraction >= TRIMESH_WEIGHT_ONE - BESIDE && p->can_open[1]) return p->end[1];
  return TRIMESH_NONE;
}

int trimesh_path_snap(const fray_world *w, const trimesh_path *path, uint32_t m, trimesh_snap *snap) {
  FRAY_ASSERT(m < 2);
  const uint32_t fraction = m == 0 ? path->fraction : TRIMESH_WEIGHT_ONE - path->fraction;
  return end_beside(path) == TRIMESH_NONE && fraction <= FARTHEST && path->can_open[m] &&
         trimesh_snap_plan(w, path->end[m], path->end[1u - m], fraction, path->norm2_most, snap);
}

/* Brings a vertex onto the path, or takes one beside it: TRIMESH_NONE, where there is none. */
static uint32_t vertex_ahead(fray_world *w, const trimesh_path *p, const trimesh_snap *snap,
                             trimesh_way *way) {
  const uint32_t nearer = trimesh_path_nearer(p);
  uint32_t added = TRIMESH_NONE;
  *way = TRIMESH_SNAPPED;
  if (snap != NULL) {
    trimesh_snap_apply(w, snap);
    return snap->vertex;
  }
  *way = TRIMESH_ALONG;
  if (end_beside(p) != TRIMESH_NONE) return end_beside(p);
  if (divides_stoutly(w, p) && trimesh_divide_edge(w, p->ring.triangle[p->n], p->ring.corner[p->n],
                                                    p->fraction, &added) == TRIMESH_DONE) {
    *way = TRIMESH_DIVIDED;
    return added;
  }
  if (p->can_open[nearer]) return p->end[nearer];
  return p->can_open[1u - nearer] ? p->end[1u - nearer] : TRIMESH_NONE;
}

trimesh_result trimesh_path_open(fray_world *w, const trimesh_path *path, const trimesh_snap *snap,
                                 trimesh_mark mark, trimesh_step *step) {
  FRAY_ASSERT(snap == NULL || snap->vertex == path->end[0] || snap->vertex == path->end[1]);
  step->end = vertex_ahead(w, path, snap, &step->way);
  if (step->end == TRIMESH_NONE) return TRIMESH_NO_PATH;
  step->end_was_boundary = trimesh_is_boundary(&w->trimesh, step->end);
  return trimesh_open_to(w, path->vertex, step->end, mark);
}

#endif
