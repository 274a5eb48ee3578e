/* SPDX-License-Identifier: Apache-2.0 */
/* The distance of two edges, or of a point and a triangle, that move, in double. Coordinates of 31
 * bits at times of 15 are exact in it; distances are right to about 1e-6 of a step of position. */
#ifndef FRAY_TESTS_PHYSICS_MOVING_DISTANCE_H
#define FRAY_TESTS_PHYSICS_MOVING_DISTANCE_H

#include <math.h>

#include "rt/geometry/ccd.h"

typedef struct {
  double x[3];
} real3;

static inline real3 real3_at(const ccd_path *p, double t) {
  const double begin[3] = {p->begin.x, p->begin.y, p->begin.z};
  const double end[3] = {p->end.x, p->end.y, p->end.z};
  real3 v;
  for (int k = 0; k < 3; ++k) v.x[k] = begin[k] + t * (end[k] - begin[k]);
  return v;
}
static inline real3 real3_minus(real3 a, real3 b) {
  const real3 v = {{a.x[0] - b.x[0], a.x[1] - b.x[1], a.x[2] - b.x[2]}};
  return v;
}
static inline double real3_dot(real3 a, real3 b) {
  return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2];
}
static inline real3 real3_cross(real3 a, real3 b) {
  const real3 v = {{a.x[1] * b.x[2] - a.x[2] * b.x[1], a.x[2] * b.x[0] - a.x[0] * b.x[2],
                    a.x[0] * b.x[1] - a.x[1] * b.x[0]}};
  return v;
}
static inline double clamped_fraction(double part, double whole) {
  return whole > 0 ? fmin(1, fmax(0, part / whole)) : 0;
}

/* The least over corners against edges, and between the lines where they pass within both. */
static inline double corner_distance(real3 p, real3 a, real3 b) {
  const real3 e = real3_minus(b, a);
  const real3 w = real3_minus(p, a);
  const double s = clamped_fraction(real3_dot(w, e), real3_dot(e, e));
  const real3 d = {{w.x[0] - s * e.x[0], w.x[1] - s * e.x[1], w.x[2] - s * e.x[2]}};
  return sqrt(real3_dot(d, d));
}
static inline double edge_distance(const real3 p[4]) {
  const real3 e = real3_minus(p[1], p[0]);
  const real3 f = real3_minus(p[3], p[2]);
  const real3 w = real3_minus(p[2], p[0]);
  const real3 n = real3_cross(e, f);
  const double nn = real3_dot(n, n);
  double least = fmin(corner_distance(p[0], p[2], p[3]), corner_distance(p[1], p[2], p[3]));
  least = fmin(least, fmin(corner_distance(p[2], p[0], p[1]), corner_distance(p[3], p[0], p[1])));
  const double u = real3_dot(real3_cross(w, f), n);
  const double v = real3_dot(real3_cross(w, e), n);
  if (nn > 0 && u >= 0 && u <= nn && v >= 0 && v <= nn)
    least = fmin(least, fabs(real3_dot(w, n)) / sqrt(nn));
  return least;
}
static inline double triangle_distance(const real3 p[4]) {
  const real3 e = real3_minus(p[2], p[1]);
  const real3 f = real3_minus(p[3], p[1]);
  const real3 w = real3_minus(p[0], p[1]);
  const real3 n = real3_cross(e, f);
  const double nn = real3_dot(n, n);
  double least = fmin(corner_distance(p[0], p[1], p[2]), corner_distance(p[0], p[2], p[3]));
  least = fmin(least, corner_distance(p[0], p[3], p[1]));
  const double u = real3_dot(real3_cross(w, f), n);
  const double v = real3_dot(real3_cross(e, w), n);
  if (nn > 0 && u >= 0 && v >= 0 && u + v <= nn)
    least = fmin(least, fabs(real3_dot(w, n)) / sqrt(nn));
  return least;
}
static inline double distance_at(const ccd_path p[4], int triangle, double t) {
  real3 v[4];
  for (int n = 0; n < 4; ++n) v[n] = real3_at(&p[n], t);
  return triangle ? triangle_distance(v) : edge_distance(v);
}

/* The least that is found in the step: at 256 times, then closer around the best. */
static inline double least_distance(const ccd_path p[4], int triangle) {
  enum { TIMES = 256 };
  double best = distance_at(p, triangle, 0);
  double at = 0;
  for (int n = 1; n <= TIMES; ++n) {
    const double d = distance_at(p, triangle, (double)n / TIMES);
    if (d < best) {
      best = d;
      at = (double)n / TIMES;
    }
  }
  double low = fmax(0, at - 1.0 / TIMES);
  double high = fmin(1, at + 1.0 / TIMES);
  for (int n = 0; n < 50; ++n) {
    const double one = low + (high - low) * 0.382;
    const double other = low + (high - low) * 0.618;
    if (distance_at(p, triangle, one) < distance_at(p, triangle, other))
      high = other;
    else
      low = one;
  }
  return fmin(best, distance_at(p, triangle, (low + high) / 2));
}

/* The largest that any of the two is long, or moves, or that they are apart, along an axis. */
static inline double extent_of(const ccd_path p[4]) {
  double low[3] = {1e300, 1e300, 1e300};
  double high[3] = {-1e300, -1e300, -1e300};
  for (int n = 0; n < 8; ++n) {
    const real3 v = real3_at(&p[n / 2], n % 2);
    for (int k = 0; k < 3; ++k) {
      low[k] = fmin(low[k], v.x[k]);
      high[k] = fmax(high[k], v.x[k]);
    }
  }
  return fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2]));
}

#endif
