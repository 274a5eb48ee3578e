/* SPDX-License-Identifier: Apache-2.0 */
/* Two triangles with a side in common: vertices 1 and 2 are opposite it, 3 and 4 its ends. */
#ifndef FRAY_STAGE_HINGE_H
#define FRAY_STAGE_HINGE_H

#include "rt/base/vec.h"
#include "rt/model/crease.h"

typedef struct {
  vec3 side;       /* from 3 to 4, Q28 */
  vec3 to1, to2;   /* from 4 */
  vec3 area1, area2; /* normals as long as twice the area: (x1 - x3) x (x1 - x4), the other way round for 2 */
} hinge;

/* Q28 of Q28. */
static inline vec3 hinge_cross(vec3 a, vec3 b) {
  return vec_make((int32_t)fx_round64(fx_mul_wide(a.y, b.z) - fx_mul_wide(a.z, b.y), 28),
                  (int32_t)fx_round64(fx_mul_wide(a.z, b.x) - fx_mul_wide(a.x, b.z), 28),
                  (int32_t)fx_round64(fx_mul_wide(a.x, b.y) - fx_mul_wide(a.y, b.x), 28));
}

static inline hinge hinge_of(vec3 side, vec3 to1, vec3 to2) {
  const hinge h = {side, to1, to2, hinge_cross(side, to1), hinge_cross(to2, side)};
  return h;
}

/* Both triangles have an area to speak of. */
static inline int hinge_is_sound(const hinge *h) {
  return vec_squared(h->area1) >= HINGE_LEAST && vec_squared(h->area2) >= HINGE_LEAST &&
         vec_squared(h->side) >= HINGE_LEAST;
}

typedef struct {
  vec3 along;      /* Q30 */
  uint32_t length; /* Q28 */
} hinge_unit;

static inline hinge_unit hinge_unit_of(vec3 v) {
  const fx_root root = fx_rsqrt(vec_squared(v), FX_ROOT_FINE);
  const hinge_unit unit = {
      vec_make(fx_root_unit(root, v.x), fx_root_unit(root, v.y), fx_root_unit(root, v.z)),
      fx_root_length(root)};
  return unit;
}

/* sin(t/2) = |n1 - n2| / 2, Q30; exact for small angles, where 2.57 is not. */
static inline int32_t hinge_half(vec3 n1, vec3 n2) {
  const vec3 off = vec_make(fx_asr(fx_wrap_sub(n1.x, n2.x), 1), fx_asr(fx_wrap_sub(n1.y, n2.y), 1),
                            fx_asr(fx_wrap_sub(n1.z, n2.z), 1));
  const uint64_t squared = vec_squared(off);
  return squared == 0 ? 0 : (int32_t)fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
}

#endif
