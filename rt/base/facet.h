/* SPDX-License-Identifier: Apache-2.0 */
/* A flat facet, a parallelogram or a triangle, and the part of it that is nearest to the origin.
 *
 * What one edge has against another is the parallelogram of all differences of their points; what
 * a triangle has against a point is the triangle of differences. They touch where it holds the
 * origin, and the distance of the two is its distance from the origin. */
#ifndef FRAY_BASE_FACET_H
#define FRAY_BASE_FACET_H

#include "rt/base/vec.h"

typedef enum { FACET_PARALLELOGRAM, FACET_TRIANGLE } facet_shape;

/* corner + u a + v b, with u, v in [0, 1], and u + v at most 1 in a triangle. */
typedef struct {
  vec3 corner, a, b;
} facet;

enum { FACET_BITS = 14 }; /* components of a facet that is looked at: at most 2^14 */

/* Which point is nearest: u = part[0] / whole[0], v = part[1] / whole[1]; 0 <= part <= whole. */
typedef struct {
  vec3 away; /* to it from the origin, any length, components to 2^30; 0 where it is the origin */
  int64_t part[2], whole[2];
} facet_nearest;

/* A vector in the direction of v whose components are at most 2^bits; v itself where they are. */
vec3 facet_narrow(vec3 v, unsigned bits);

/* For components of at most 2^FACET_BITS. Which part is nearest, the inside, an edge or a corner,
 * is exact; so is the direction to the inside (the normal) and to a corner; to an edge it is
 * rounded once, to 14 bits. Cost: no loops, no divisions. Source: Ericson 2005, 5.1.5 and 5.1.9. */
facet_nearest facet_look(const facet *f, facet_shape shape);

static inline vec3 facet_cross(vec3 a, vec3 b) {
  return vec_make(fx_sub(fx_mul(a.y, b.z), fx_mul(a.z, b.y)),
                  fx_sub(fx_mul(a.z, b.x), fx_mul(a.x, b.z)),
                  fx_sub(fx_mul(a.x, b.y), fx_mul(a.y, b.x)));
}
static inline int32_t facet_dot(vec3 a, vec3 b) {
  return fx_add(fx_add(fx_mul(a.x, b.x), fx_mul(a.y, b.y)), fx_mul(a.z, b.z));
}
static inline int64_t facet_dot_wide(vec3 a, vec3 b) {
  return fx_add64(fx_add64(fx_mul_wide(a.x, b.x), fx_mul_wide(a.y, b.y)), fx_mul_wide(a.z, b.z));
}
/* The bits of the largest component, one more than those of v's own where v is -2^n. */
static inline uint32_t facet_span(vec3 v) {
  return (uint32_t)(v.x ^ fx_asr(v.x, 31)) | (uint32_t)(v.y ^ fx_asr(v.y, 31)) |
         (uint32_t)(v.z ^ fx_asr(v.z, 31));
}
/* How far to shift so that what has this span fits in `bits`. */
static inline unsigned facet_excess(uint32_t span, unsigned bits) {
  const unsigned width = span == 0 ? 0 : 32u - (unsigned)__builtin_clz(span);
  return width > bits ? width - bits : 0;
}
static inline vec3 facet_shifted(vec3 v, unsigned s) {
  return s == 0 ? v : vec_make(fx_round(v.x, s), fx_round(v.y, s), fx_round(v.z, s));
}

#endif
