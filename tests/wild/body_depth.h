/* SPDX-License-Identifier: Apache-2.0 */
/* How deep particles are in spheres, boxes, capsules and planes that they were outside of before:
 * in double precision, at the ends of ticks. Rigid meshes are tests/physics' to judge, in exact
 * arithmetic. */
#ifndef FRAY_TESTS_WILD_BODY_DEPTH_H
#define FRAY_TESTS_WILD_BODY_DEPTH_H

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

#include "rt/fray.h"
#include "rt/state/rigid_mesh.h"
#include "tests/physics/moving_distance.h"

typedef struct {
  uint32_t bodies, particles;
  uint8_t *outside; /* body, then particle: it was */
} body_depth;

static inline body_depth *body_depth_open(const fray_world *w) {
  const fray_info f = fray_get_info(w);
  body_depth *d = malloc(sizeof *d);
  if (d == NULL) abort();
  d->bodies = f.bodies;
  d->particles = f.particles_max;
  d->outside = calloc((size_t)f.bodies * f.particles_max + 1u, 1);
  if (d->outside == NULL) abort();
  return d;
}
static inline void body_depth_close(body_depth *d) {
  if (d == NULL) return;
  free(d->outside);
  free(d);
}

/* Below the surface, Q24 lu; below 0 outside. */
static inline double body_depth_at(const fray_body *b, const double at[3]) {
  double own[3];
  double away[3];
  for (int n = 0; n < 3; ++n) {
    own[n] = 0;
    for (int k = 0; k < 3; ++k) own[n] += b->axes[3 * n + k] * 0x1p-30 * (at[k] - b->position[k]);
    away[n] = fabs(own[n]) - b->half[n];
  }
  if (b->shape == FRAY_PLANE) return -own[1];
  if (b->shape == FRAY_BOX) return -fmax(away[0], fmax(away[1], away[2]));
  const double along = b->shape == FRAY_CAPSULE ? fmax(away[0], 0) : own[0];
  return b->radius - sqrt(along * along + own[1] * own[1] + own[2] * own[2]);
}

static inline int body_depth_knows(const fray_body *b) {
  return b->shape != FRAY_ANCHOR && b->shape != FRAY_MESH;
}

/* A face of the mesh is no farther than this. */
static inline int body_depth_mesh_is_near(const fray_world *w, uint32_t body, const double at[3], double near) {
  const rigid_mesh_parts m = rigid_mesh_at(w, rigid_mesh_of_body(w, body));
  const int32_t *from = w->rigid.states[body].position;
  real3 p[4];
  for (int n = 0; n < 3; ++n) p[0].x[n] = at[n] - from[n];
  for (int32_t f = 0; f < m.of->faces; ++f) {
    for (int k = 0; k < 3; ++k)
      for (int n = 0; n < 3; ++n) p[k + 1].x[n] = m.points[m.faces[f].point[k]].at[n];
    if (triangle_distance(p) < near) return 1;
  }
  return 0;
}

/* Another body is no farther than this: bodies do not stop each other, so what is between two is in one. */
static inline int body_depth_is_squeezed(const fray_world *w, uint32_t bodies, uint32_t body, const double at[3],
                                         double near) {
  for (uint32_t n = 0; n < bodies; ++n) {
    const fray_body b = fray_view_body(w, n);
    if (n == body) continue;
    if (body_depth_knows(&b) && body_depth_at(&b, at) > -near) return 1;
    if (b.shape == FRAY_MESH && body_depth_mesh_is_near(w, n, at, near)) return 1;
  }
  return 0;
}

/* The deepest of those that were outside of the body, and since then were not squeezed into it, or 0. */
static inline double body_depth_update(body_depth *d, const fray_world *w) {
  const fray_particles v = fray_view_particles(w);
  const double near = 2.0 * fray_get_info(w).thickness;
  double deepest = 0;
  for (uint32_t n = 0; n < d->bodies; ++n) {
    const fray_body b = fray_view_body(w, n);
    if (!body_depth_knows(&b)) continue;
    uint8_t *outside = d->outside + (size_t)n * d->particles;
    for (uint32_t p = v.attached; p < v.count; ++p) {
      const double at[3] = {v.x[p], v.y[p], v.z[p]};
      const double depth = body_depth_at(&b, at);
      if (depth <= 0) outside[p] = 1;
      if (!outside[p] || depth <= deepest) continue;
      if (!body_depth_is_squeezed(w, d->bodies, n, at, near))
        deepest = depth;
      else if (depth > near)
        outside[p] = 0;
    }
  }
  return deepest;
}

#endif
