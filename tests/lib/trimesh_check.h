/* SPDX-License-Identifier: Apache-2.0 */
/* Walks a membrane and says what is wrong with it; it uses nothing of what tears and cuts use.
 *
 *   trimesh_check k;
 *   trimesh_check_open(&k, w);
 *   ... a tear or cut ...; trimesh_check_now(&k, w);
 *   CHECK_EQ_INT(k.bad, 0);
 */
#ifndef FRAY_TESTS_LIB_TRIMESH_CHECK_H
#define FRAY_TESTS_LIB_TRIMESH_CHECK_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rt/state/world.h"

typedef struct {
  uint64_t area;        /* of the whole sheet */
  int64_t momentum[3];
  uint32_t particles, triangles; /* never fewer than before */
  uint32_t bad;
  double worst_area;   /* a stored area off the one in rest coordinates, Q30 lu^2 */
  double worst_weight; /* relative */
} trimesh_check;

static inline void trimesh_check_bad(trimesh_check *k, const char *what, uint32_t at) {
  if (k->bad++ < 10) printf("trimesh_check: %s %u\n", what, at);
}

static inline void trimesh_check_sums(const fray_world *w, uint64_t *area, int64_t momentum[3]) {
  const trimesh *s = &w->trimesh;
  const int32_t *const speed[3] = {w->p.vx, w->p.vy, w->p.vz};
  *area = 0;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) *area += s->area[t];
  for (uint32_t n = 0; n < 3; ++n) {
    uint64_t sum = (uint64_t)(int64_t)s->state->momentum_remainder[n]; /* wraps as momentum does; what is compared is all of its bits */
    for (uint32_t p = 0; p < w->p.count; ++p)
      sum += (uint64_t)((int64_t)s->mass[p] * speed[n][p]);
    momentum[n] = (int64_t)sum;
  }
}

static inline void trimesh_check_open(trimesh_check *k, const fray_world *w) {
  memset(k, 0, sizeof *k);
  trimesh_check_sums(w, &k->area, k->momentum);
  k->particles = w->p.count;
  k->triangles = (uint32_t)w->trimesh.state->triangles;
}

static inline double trimesh_check_twice(const trimesh *s, uint32_t a, uint32_t b, uint32_t c) {
  const double l = 1.0 / (1 << 24);
  const double bu = l * ((double)s->u[b] - s->u[a]), bv = l * ((double)s->v[b] - s->v[a]);
  const double cu = l * ((double)s->u[c] - s->u[a]), cv = l * ((double)s->v[c] - s->v[a]);
  return bu * cv - bv * cu;
}

static inline double trimesh_check_length(const trimesh *s, uint32_t a, uint32_t b) {
  return hypot((double)s->u[b] - s->u[a], (double)s->v[b] - s->v[a]) / (1 << 24);
}

/* Orientation, floors, stored area and weights of one triangle. */
static inline void trimesh_check_shape(trimesh_check *k, const trimesh *s, uint32_t t) {
  const index_t *v = s->triangle[t].v;
  const double twice = trimesh_check_twice(s, v[0], v[1], v[2]);
  const double floor_area = s->params->area_min / 1073741824.0;
  const double floor_height = s->params->height_min / 16777216.0;
  const double longest = fmax(fmax(trimesh_check_length(s, v[0], v[1]), trimesh_check_length(s, v[1], v[2])),
                              trimesh_check_length(s, v[2], v[0]));
  if (twice <= 0) trimesh_check_bad(k, "orientation of triangle", t);
  if (twice / 2 < floor_area * (1 - 1e-9)) trimesh_check_bad(k, "area of triangle", t);
  if (twice / longest < floor_height * (1 - 1e-6)) trimesh_check_bad(k, "sliver: triangle", t);
  const double off = fabs(twice / 2 * 1073741824.0 - s->area[t]);
  if (off > k->worst_area) k->worst_area = off;
  const double l = 1.0 / (1 << 24);
  const double expected[4] = {
      l * ((double)s->v[v[2]] - s->v[v[0]]) / twice, l * ((double)s->v[v[0]] - s->v[v[1]]) / twice,
      l * ((double)s->u[v[0]] - s->u[v[2]]) / twice, l * ((double)s->u[v[1]] - s->u[v[0]]) / twice};
  const int32_t have[4] = {s->weights[t].u1, s->weights[t].u2, s->weights[t].v1, s->weights[t].v2};
  for (uint32_t n = 0; n < 4; ++n) {
    const double error = fabs((double)have[n] / (1 << TRIMESH_WEIGHT_BITS) - expected[n]);
    if (error > k->worst_weight) k->worst_weight = error;
  }
}

static inline void trimesh_check_triangle(trimesh_check *k, const fray_world *w, uint32_t t) {
  const trimesh *s = &w->trimesh;
  const trimesh_triangle *f = &s->triangle[t];
  for (uint32_t n = 0; n < 3; ++n) {
    const uint32_t across = f->neighbour[n];
    if (f->v[n] >= w->p.count || across >= (uint32_t)s->state->triangles) {
      trimesh_check_bad(k, "an id out of range in triangle", t);
      return;
    }
    if (f->v[n] == f->v[(n + 1) % 3]) trimesh_check_bad(k, "a corner twice: triangle", t);
    if (across == t) continue;
    const trimesh_triangle *o = &s->triangle[across];
    uint32_t meet = 0;
    for (uint32_t m = 0; m < 3; ++m)
      if (o->neighbour[m] == t && o->v[(m + 1) % 3] == f->v[(n + 2) % 3] &&
          o->v[(m + 2) % 3] == f->v[(n + 1) % 3]) {
        ++meet;
        if ((s->edge_marks[t] >> 2 * n & 3) != 0 || (s->edge_marks[across] >> 2 * m & 3) != 0)
          trimesh_check_bad(k, "a mark on a closed side of triangle", t);
      }
    if (meet != 1) trimesh_check_bad(k, "adjacency of triangle", t);
  }
  trimesh_check_shape(k, s, t);
}

/* All corners at a vertex are reached by going round it from its first triangle. */
static inline void trimesh_check_one_ring(trimesh_check *k, const fray_world *w, uint32_t p,
                                   uint32_t corners) {
  const trimesh *s = &w->trimesh;
  uint32_t t = s->first_triangle[p];
  uint32_t reached = 0;
  if (corners == 0 || corners > TRIMESH_RING_MAX) trimesh_check_bad(k, "triangles at vertex", p);
  for (;;) {
    uint32_t c = 0;
    while (c < 3 && s->triangle[t].v[c] != p) ++c;
    if (c == 3 || reached > corners) {
      trimesh_check_bad(k, "the fan of vertex", p);
      return;
    }
    ++reached;
    const uint32_t next = s->triangle[t].neighbour[(c + 1) % 3];
    const uint32_t before = s->triangle[t].neighbour[(c + 2) % 3];
    if (next == t) { /* open: then the first one is at the other border */
      const uint32_t first = s->first_triangle[p];
      uint32_t at = 0;
      while (at < 3 && s->triangle[first].v[at] != p) ++at;
      if (at == 3 || s->triangle[first].neighbour[(at + 2) % 3] != first)
        trimesh_check_bad(k, "the first triangle of vertex", p);
      break;
    }
    if (reached == 1 && before == t && corners == 1) trimesh_check_bad(k, "a lone fan at", p);
    if (next == s->first_triangle[p]) break;
    t = next;
  }
  if (reached != corners) trimesh_check_bad(k, "two fans at vertex", p);
}

static inline void trimesh_check_vertices(trimesh_check *k, const fray_world *w) {
  const trimesh *s = &w->trimesh;
  uint32_t *corners = calloc(w->p.count, sizeof *corners);
  uint32_t *mass = calloc(w->p.count, sizeof *mass);
  if (corners == NULL || mass == NULL) exit(1);
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t)
    for (uint32_t n = 0; n < 3; ++n) {
      ++corners[s->triangle[t].v[n]];
      mass[s->triangle[t].v[n]] += s->area[t];
    }
  for (uint32_t p = 0; p < w->p.count; ++p) {
    if (mass[p] != s->mass[p]) trimesh_check_bad(k, "mass of vertex", p);
    trimesh_check_one_ring(k, w, p, corners[p]);
  }
  free(corners);
  free(mass);
}

static inline void trimesh_check_now(trimesh_check *k, const fray_world *w) {
  const trimesh *s = &w->trimesh;
  const uint32_t bad = k->bad;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) trimesh_check_triangle(k, w, t);
  if (k->bad != bad) return; /* fans cannot be walked */
  trimesh_check_vertices(k, w);
  uint64_t area;
  int64_t momentum[3];
  trimesh_check_sums(w, &area, momentum);
  if (area != k->area) trimesh_check_bad(k, "area of the sheet, triangles", (uint32_t)s->state->triangles);
  for (uint32_t n = 0; n < 3; ++n)
    if (momentum[n] != k->momentum[n]) trimesh_check_bad(k, "momentum, axis", n);
  if (w->p.count < k->particles || (uint32_t)s->state->triangles < k->triangles ||
      w->p.count != (uint32_t)(w->params->particles + s->state->allocated) ||
      w->p.count > w->capacity[POOL_PARTICLES] ||
      (uint32_t)s->state->triangles > w->capacity[POOL_TRIANGLES])
    trimesh_check_bad(k, "pools: particles", w->p.count);
  k->particles = w->p.count;
  k->triangles = (uint32_t)s->state->triangles;
  const uint64_t topology =
      (uint64_t)(uint32_t)w->state->topology[1] << 32 | (uint32_t)w->state->topology[0];
  if (trimesh_topology(w) != topology) trimesh_check_bad(k, "hash of the topology, particles", w->p.count);
}

#endif
