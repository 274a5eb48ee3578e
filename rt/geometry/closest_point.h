/* SPDX-License-Identifier: Apache-2.0 */
/* The closest point to the origin of a Minkowski difference that is flat: of two edges a parallelogram, of
 * a triangle and a point a triangle. The two touch where the face contains the origin, and their distance
 * is that of the face from the origin. */
#ifndef FRAY_GEOMETRY_CLOSEST_POINT_H
#define FRAY_GEOMETRY_CLOSEST_POINT_H

#include "rt/base/vec.h"

typedef enum { CLOSEST_PARALLELOGRAM, CLOSEST_TRIANGLE } closest_shape;

/* The points corner + u a + v b with u, v in [0, 1], in a triangle u + v <= 1 too. */
typedef struct {
  vec3 corner, a, b;
} closest_face;

enum { CLOSEST_BITS = 14 }; /* components of a face that is searched: at most 2^14 */

/* The closest point in barycentric coordinates: u = part[0] / whole[0], v = part[1] / whole[1],
 * 0 <= part <= whole. */
typedef struct {
  vec3 away; /* the direction to it from the origin, of any length, components to 2^30; 0 where it is the
                origin */
  int64_t part[2], whole[2];
} closest_point;

/* A vector in the direction of v whose components are at most 2^bits; v itself where they are. */
vec3 closest_narrow(vec3 v, unsigned bits);

/* For components of at most 2^CLOSEST_BITS. Which region is closest, the interior, an edge or a corner, is
 * exact; so is the direction to the interior (the normal) and to a corner; that to an edge is rounded once,
 * to 14 bits. Cost: no loops, no divisions. Source: Ericson 2005, 5.1.5 and 5.1.9. */
closest_point closest_point_find(const closest_face *f, closest_shape shape);

/* part / whole in Q15, rounded down, for 0 <= part <= whole, whole > 0. */
static inline int32_t closest_ratio(int64_t part, int64_t whole) {
  FRAY_ASSERT(part >= 0 && part <= whole && whole > 0);
  const unsigned lz = fx_leading_zeros64((uint64_t)whole);
  const unsigned s = lz < 48u ? 48u - lz : 0;
  if (s == 0) return (int32_t)(((uint32_t)part << 15) / (uint32_t)whole);
  return (int32_t)(((uint32_t)(part >> s) << 15) / ((uint32_t)(whole >> s) + 1u));
}
/* Coordinate n of a closest point, Q15, rounded down; 0 where the face is flat. */
static inline int32_t closest_weight(const closest_point *nearest, uint32_t n) {
  return nearest->whole[n] > 0 ? closest_ratio(nearest->part[n], nearest->whole[n]) : 0;
}

/* An OR of the magnitudes of the components: its width is that of the largest (of -2^n it is n). */
static inline uint32_t closest_span(vec3 v) {
  return (uint32_t)(v.x ^ fx_asr(v.x, 31)) | (uint32_t)(v.y ^ fx_asr(v.y, 31)) |
         (uint32_t)(v.z ^ fx_asr(v.z, 31));
}
/* The right shift after which values of this span fit `bits`. */
static inline unsigned closest_excess(uint32_t span, unsigned bits) {
  const unsigned width = span == 0 ? 0 : 32u - (unsigned)__builtin_clz(span);
  return width > bits ? width - bits : 0;
}
static inline vec3 closest_shifted(vec3 v, unsigned s) { return s == 0 ? v : vec_round(v, s); }

#endif
