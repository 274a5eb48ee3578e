/* SPDX-License-Identifier: Apache-2.0 */
/* How deep triangles of a sheet are in a ball or a box at the end of a tick, in double precision, in lu. */
#ifndef FRAY_TESTS_LIB_DEPTH_H
#define FRAY_TESTS_LIB_DEPTH_H

#include <math.h>

#include "rt/state/rigid_mesh.h"
#include "tests/lib/world_fixture.h"

typedef struct {
  double x, y, z;
} depth_point;

FIXTURE double depth_dot(depth_point a, depth_point b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
FIXTURE depth_point depth_minus(depth_point a, depth_point b) {
  const depth_point d = {a.x - b.x, a.y - b.y, a.z - b.z};
  return d;
}
FIXTURE depth_point depth_between(depth_point a, depth_point b, double t) {
  const depth_point d = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z)};
  return d;
}
/* A vertex as seen from a place. */
FIXTURE depth_point depth_relative(const fray_world *w, uint32_t p, const int32_t at[3]) {
  const depth_point v = {(w->p.x[p] - (double)at[0]) * 0x1p-24, (w->p.y[p] - (double)at[1]) * 0x1p-24,
                         (w->p.z[p] - (double)at[2]) * 0x1p-24};
  return v;
}

/* Of the origin from a side. */
FIXTURE double depth_from_edge(depth_point a, depth_point b) {
  const depth_point e = depth_minus(b, a);
  const double t = fmin(1, fmax(0, -depth_dot(a, e) / fmax(depth_dot(e, e), 1e-30)));
  const depth_point n = depth_between(a, b, t);
  return sqrt(depth_dot(n, n));
}
FIXTURE double depth_from_triangle(depth_point a, depth_point b, depth_point c) {
  const depth_point e = depth_minus(b, a);
  const depth_point f = depth_minus(c, a);
  const depth_point n = {e.y * f.z - e.z * f.y, e.z * f.x - e.x * f.z, e.x * f.y - e.y * f.x};
  const double ee = depth_dot(e, e);
  const double ff = depth_dot(f, f);
  const double ef = depth_dot(e, f);
  const double whole = ee * ff - ef * ef;
  const double u = (ef * depth_dot(f, a) - ff * depth_dot(e, a)) / fmax(whole, 1e-30);
  const double v = (ef * depth_dot(e, a) - ee * depth_dot(f, a)) / fmax(whole, 1e-30);
  if (whole > 1e-20 && u >= 0 && v >= 0 && u + v <= 1) return fabs(depth_dot(n, a)) / sqrt(depth_dot(n, n));
  return fmin(depth_from_edge(a, b), fmin(depth_from_edge(b, c), depth_from_edge(c, a)));
}

FIXTURE int depth_apart(const depth_point v[3], double reach) {
  return fmin(v[0].x, fmin(v[1].x, v[2].x)) > reach || fmax(v[0].x, fmax(v[1].x, v[2].x)) < -reach ||
         fmin(v[0].y, fmin(v[1].y, v[2].y)) > reach || fmax(v[0].y, fmax(v[1].y, v[2].y)) < -reach ||
         fmin(v[0].z, fmin(v[1].z, v[2].z)) > reach || fmax(v[0].z, fmax(v[1].z, v[2].z)) < -reach;
}

/* Of a ball of the world; below 0 where none is in it. */
FIXTURE double depth_in_sphere(const fray_world *w, uint32_t b) {
  const int32_t *at = w->rigid.states[b].position;
  const double radius = w->rigid.bodies[b].radius * 0x1p-24;
  double deepest = -1e9;
  for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t) {
    const index_t *of = w->trimesh.triangle[t].v;
    const depth_point v[3] = {depth_relative(w, of[0], at), depth_relative(w, of[1], at), depth_relative(w, of[2], at)};
    if (!depth_apart(v, radius)) deepest = fmax(deepest, radius - depth_from_triangle(v[0], v[1], v[2]));
  }
  return deepest;
}

/* How deep a place is in a convex mesh, below 0 outside. */
FIXTURE double depth_of_point(const rigid_mesh_parts *m, uint32_t faces, depth_point p) {
  double least = 1e9;
  for (uint32_t n = 0; n < faces; ++n) {
    const vec3 a = rigid_mesh_corner(m, n, 0);
    const int32_t *normal = m->faces[n].normal;
    const depth_point out = {normal[0] * 0x1p-30, normal[1] * 0x1p-30, normal[2] * 0x1p-30};
    const depth_point from = {p.x - a.x * 0x1p-24, p.y - a.y * 0x1p-24, p.z - a.z * 0x1p-24};
    least = fmin(least, -depth_dot(out, from));
  }
  return least;
}

/* The most along a side: depth in a convex mesh has one summit. */
FIXTURE double depth_along(const rigid_mesh_parts *m, uint32_t faces, depth_point a, depth_point b) {
  double low = 0, high = 1;
  while (high - low > 1e-4) {
    const double one = low + (high - low) / 3, two = high - (high - low) / 3;
    if (depth_of_point(m, faces, depth_between(a, b, one)) < depth_of_point(m, faces, depth_between(a, b, two)))
      low = one;
    else
      high = two;
  }
  return depth_of_point(m, faces, depth_between(a, b, low));
}

FIXTURE int depth_outside(const rigid_mesh_parts *m, uint32_t faces, const depth_point v[3]) {
  for (uint32_t n = 0; n < faces; ++n) {
    const vec3 a = rigid_mesh_corner(m, n, 0);
    const int32_t *normal = m->faces[n].normal;
    uint32_t out = 0;
    for (uint32_t k = 0; k < 3; ++k)
      out += (v[k].x - a.x * 0x1p-24) * normal[0] + (v[k].y - a.y * 0x1p-24) * normal[1] +
                 (v[k].z - a.z * 0x1p-24) * normal[2] >= 0;
    if (out == 3) return 1;
  }
  return 0;
}

/* Of the triangles in a convex mesh, the summit over each; below 0 where none is in it. */
FIXTURE double depth_in_mesh(const fray_world *w, const rigid_mesh_parts *m, uint32_t b) {
  const uint32_t faces = (uint32_t)m->of->faces;
  const int32_t *at = w->rigid.states[b].position;
  const int32_t *reach = w->rigid.bodies[b].aabb_half;
  const double far = fmax(reach[0], fmax(reach[1], reach[2])) * 0x1p-24;
  double deepest = -1e9;
  for (uint32_t t = 0; t < (uint32_t)w->trimesh.state->triangles; ++t) {
    const index_t *of = w->trimesh.triangle[t].v;
    const depth_point v[3] = {depth_relative(w, of[0], at), depth_relative(w, of[1], at), depth_relative(w, of[2], at)};
    if (depth_apart(v, far) || depth_outside(m, faces, v)) continue;
    double low = 0, high = 1;
    while (high - low > 1e-3) {
      const double one = low + (high - low) / 3, two = high - (high - low) / 3;
      if (depth_along(m, faces, depth_between(v[0], v[1], one), depth_between(v[0], v[2], one)) <
          depth_along(m, faces, depth_between(v[0], v[1], two), depth_between(v[0], v[2], two)))
        low = one;
      else
        high = two;
    }
    deepest = fmax(deepest, depth_along(m, faces, depth_between(v[0], v[1], low), depth_between(v[0], v[2], low)));
  }
  return deepest;
}

#endif
