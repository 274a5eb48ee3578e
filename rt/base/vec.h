/* SPDX-License-Identifier: Apache-2.0 */
/* Three-component integer vectors. */
#ifndef FRAY_BASE_VEC_H
#define FRAY_BASE_VEC_H

#include "rt/base/fx.h"

typedef struct {
  int32_t x, y, z;
} vec3;

static inline vec3 vec_make(int32_t x, int32_t y, int32_t z) {
  const vec3 v = {x, y, z};
  return v;
}
static inline vec3 vec_add(vec3 a, vec3 b) {
  return vec_make(fx_add(a.x, b.x), fx_add(a.y, b.y), fx_add(a.z, b.z));
}
static inline vec3 vec_sub(vec3 a, vec3 b) {
  return vec_make(fx_sub(a.x, b.x), fx_sub(a.y, b.y), fx_sub(a.z, b.z));
}
/* |v|^2; below 3 * 2^62. */
static inline uint64_t vec_squared(vec3 v) {
  return fx_square(v.x) + fx_square(v.y) + fx_square(v.z);
}
/* a . unit, where unit is Q30: in a's format. Fits: |a . unit| <= |a| < 2^32, saturated. */
static inline int32_t vec_dot_unit(vec3 a, vec3 unit) {
  const int64_t sum = fx_add64(fx_add64(fx_mul_wide(a.x, unit.x), fx_mul_wide(a.y, unit.y)),
                               fx_mul_wide(a.z, unit.z));
  return fx_saturate(fx_round64(sum, 30));
}
/* unit * length, unit in Q30. */
static inline vec3 vec_scale_unit(vec3 unit, int32_t length) {
  return vec_make((int32_t)fx_round64(fx_mul_wide(unit.x, length), 30),
                  (int32_t)fx_round64(fx_mul_wide(unit.y, length), 30),
                  (int32_t)fx_round64(fx_mul_wide(unit.z, length), 30));
}

/* v, made shorter iff it is longer than `limit`. */
static inline vec3 vec_limited(vec3 v, int32_t limit) {
  const uint64_t n = vec_squared(v);
  if (n <= fx_square(limit)) return v;
  const fx_root root = fx_rsqrt(n, FX_ROOT_FINE);
  return vec_scale_unit(vec_make(fx_root_unit(root, v.x), fx_root_unit(root, v.y),
                                 fx_root_unit(root, v.z)), limit);
}

#endif
