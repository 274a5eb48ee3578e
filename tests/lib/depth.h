/* SPDX-License-Identifier: Apache-2.0 */
/* How deep triangles of a sheet are in a ball or a box at the end of a tick, in double precision, in lu. */
#ifndef FRAY_TESTS_DEPTH_H
#define FRAY_TESTS_DEPTH_H

#include <math.h>

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
FIXTURE depth_point depth_seen(const fray_world *w, uint32_t p, const int32_t at[3]) {
  const depth_point v = {(w->x[p] - (double)at[0]) * 0x1p-24, (w->y[p] - (double)at[1]) * 0x1p-24,
                         (w->z[p] - (double)at[2]) * 0x1p-24};
  return v;
}

/* Of the origin from a side. */
FIXTURE double depth_from_side(depth_point a, depth_point b) {
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
  return fmin(depth_from_side(a, b), fmin(depth_from_side(b, c), depth_from_side(c, a)));
}

FIXTURE int depth_apart(const depth_point v[3], double reach) {
  return fmin(v[0].x, fmin(v[1].x, v[2].x)) > reach || fmax(v[0].x, fmax(v[1].x, v[2].x)) < -reach ||
         fmin(v[0].y, fmin(v[1].y, v[2].y)) > reach || fmax(v[0].y, fmax(v[1].y, v[2].y)) < -reach ||
         fmin(v[0].z, fmin(v[1].z, v[2].z)) > reach || fmax(v[0].z, fmax(v[1].z, v[2].z)) < -reach;
}

/* Of a ball of the world; below 0 where none is in it. */
FIXTURE double depth_in_ball(const fray_world *w, uint32_t b) {
  const int32_t *at = w->body_states[b].position;
  const double radius = w->bodies[b].radius * 0x1p-24;
  double deepest = -1e9;
  for (uint32_t t = 0; t < (uint32_t)w->sheet.state->triangles; ++t) {
    const row_id *of = w->sheet.triangle[t].v;
    const depth_point v[3] = {depth_seen(w, of[0], at), depth_seen(w, of[1], at), depth_seen(w, of[2], at)};
    if (!depth_apart(v, radius)) deepest = fmax(deepest, radius - depth_from_triangle(v[0], v[1], v[2]));
  }
  return deepest;
}

#endif
