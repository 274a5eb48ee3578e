/* SPDX-License-Identifier: Apache-2.0 */
/* Three-component integer vectors in any fixed-point format. Sums and products that were proved to fit are
 * checked in checked builds. Functions round to nearest, halves away from zero, unless they say otherwise;
 * the name of a function says the format of a factor. */
#ifndef FRAY_BASE_VEC_H
#define FRAY_BASE_VEC_H

#include "rt/base/fx.h"

typedef struct {
  int32_t x, y, z;
} vec3;

/* Where a point is when a step begins and when it ends. */
typedef struct {
  vec3 begin, end;
} vec_path;

/* Products of two vec3, before they are rounded. */
typedef struct {
  int64_t x, y, z;
} vec64;

static inline vec3 vec_make(int32_t x, int32_t y, int32_t z) {
  const vec3 v = {x, y, z};
  return v;
}
static inline vec3 vec_of(const int32_t v[3]) { return vec_make(v[0], v[1], v[2]); }
static inline void vec_store(int32_t to[3], vec3 v) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}
/* Element n of three arrays. */
static inline vec3 vec_at(const int32_t *x, const int32_t *y, const int32_t *z, uint32_t n) {
  return vec_make(x[n], y[n], z[n]);
}
static inline int vec_is_equal(vec3 a, vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
static inline void vec_add_at(int32_t *x, int32_t *y, int32_t *z, uint32_t n, vec3 v) {
  x[n] = fx_add(x[n], v.x);
  y[n] = fx_add(y[n], v.y);
  z[n] = fx_add(z[n], v.z);
}
static inline vec3 vec_add(vec3 a, vec3 b) {
  return vec_make(fx_add(a.x, b.x), fx_add(a.y, b.y), fx_add(a.z, b.z));
}
static inline vec3 vec_sub(vec3 a, vec3 b) {
  return vec_make(fx_sub(a.x, b.x), fx_sub(a.y, b.y), fx_sub(a.z, b.z));
}
static inline vec3 vec_negated(vec3 v) { return vec_make(fx_sub(0, v.x), fx_sub(0, v.y), fx_sub(0, v.z)); }
static inline vec3 vec_wrap_add(vec3 a, vec3 b) {
  return vec_make(fx_wrap_add(a.x, b.x), fx_wrap_add(a.y, b.y), fx_wrap_add(a.z, b.z));
}
static inline vec3 vec_wrap_sub(vec3 a, vec3 b) {
  return vec_make(fx_wrap_sub(a.x, b.x), fx_wrap_sub(a.y, b.y), fx_wrap_sub(a.z, b.z));
}
static inline vec64 vec_add64(vec64 a, vec64 b) {
  const vec64 sum = {fx_add64(a.x, b.x), fx_add64(a.y, b.y), fx_add64(a.z, b.z)};
  return sum;
}
static inline vec64 vec_sub64(vec3 a, vec3 b) {
  const vec64 difference = {(int64_t)a.x - b.x, (int64_t)a.y - b.y, (int64_t)a.z - b.z};
  return difference;
}
/* Each component to 32 bits, +-limit. */
static inline vec3 vec_clamp64(vec64 v, int32_t limit) {
  return vec_make(fx_clamp_wide(v.x, limit), fx_clamp_wide(v.y, limit), fx_clamp_wide(v.z, limit));
}
static inline vec3 vec_add_clamped(vec3 a, vec3 b, int32_t limit) {
  const vec64 sum = {(int64_t)a.x + b.x, (int64_t)a.y + b.y, (int64_t)a.z + b.z};
  return vec_clamp64(sum, limit);
}
static inline vec3 vec_sub_clamped(vec3 a, vec3 b, int32_t limit) {
  return vec_clamp64(vec_sub64(a, b), limit);
}
static inline vec3 vec_sub_saturated(vec3 a, vec3 b) { return vec_sub_clamped(a, b, INT32_MAX); }
static inline vec3 vec_min(vec3 a, vec3 b) {
  return vec_make(fx_min(a.x, b.x), fx_min(a.y, b.y), fx_min(a.z, b.z));
}
static inline vec3 vec_max(vec3 a, vec3 b) {
  return vec_make(fx_max(a.x, b.x), fx_max(a.y, b.y), fx_max(a.z, b.z));
}
/* Each component to +-limit; and where almost none is outside. */
static inline vec3 vec_clamp(vec3 v, int32_t limit) {
  return vec_make(fx_clamp(v.x, -limit, limit), fx_clamp(v.y, -limit, limit), fx_clamp(v.z, -limit, limit));
}
static inline vec3 vec_clamp_rare(vec3 v, int32_t limit) {
  return vec_make(fx_clamp_rare(v.x, -limit, limit), fx_clamp_rare(v.y, -limit, limit),
                  fx_clamp_rare(v.z, -limit, limit));
}
/* No component is longer than the distance. */
static inline int vec_is_within(vec3 v, int32_t distance) {
  const uint32_t most = (uint32_t)distance;
  return fx_magnitude(v.x) <= most && fx_magnitude(v.y) <= most && fx_magnitude(v.z) <= most;
}
/* No component is longer than this; the width is that of the longest one. */
static inline uint32_t vec_span(vec3 v) { return fx_magnitude(v.x) | fx_magnitude(v.y) | fx_magnitude(v.z); }

/* v 2^-s, rounded down. */
static inline vec3 vec_asr(vec3 v, unsigned s) {
  return vec_make(fx_asr(v.x, s), fx_asr(v.y, s), fx_asr(v.z, s));
}
/* v 2^-s. */
static inline vec3 vec_round(vec3 v, unsigned s) {
  return vec_make(fx_round(v.x, s), fx_round(v.y, s), fx_round(v.z, s));
}
static inline vec3 vec_round64(vec64 v, unsigned s) {
  return vec_make((int32_t)fx_round64(v.x, s), (int32_t)fx_round64(v.y, s), (int32_t)fx_round64(v.z, s));
}
static inline vec3 vec_round_clamped(vec64 v, unsigned s, int32_t limit) {
  const vec64 rounded = {fx_round64(v.x, s), fx_round64(v.y, s), fx_round64(v.z, s)};
  return vec_clamp64(rounded, limit);
}
static inline vec3 vec_round_saturated(vec64 v, unsigned s) { return vec_round_clamped(v, s, INT32_MAX); }
/* v 2^-s, rounded down. */
static inline vec3 vec_asr64(vec64 v, unsigned s) {
  return vec_make((int32_t)fx_asr64(v.x, s), (int32_t)fx_asr64(v.y, s), (int32_t)fx_asr64(v.z, s));
}
/* v * factor where that fits 32 bits. */
static inline vec3 vec_mul(vec3 v, int32_t factor) {
  return vec_make(fx_mul(v.x, factor), fx_mul(v.y, factor), fx_mul(v.z, factor));
}
/* v * scale, exact. */
static inline vec64 vec_scale64(vec3 v, int32_t scale) {
  const vec64 scaled = {fx_mul_wide(v.x, scale), fx_mul_wide(v.y, scale), fx_mul_wide(v.z, scale)};
  return scaled;
}

/* v 2^-s, rounded down, for the least s with which components are below 2^bits. */
static inline vec3 vec_narrow64(vec64 v, unsigned bits) {
  const int64_t all = (v.x < 0 ? -v.x : v.x) | (v.y < 0 ? -v.y : v.y) | (v.z < 0 ? -v.z : v.z) | 1;
  const unsigned width = 64u - fx_leading_zeros64((uint64_t)all);
  return vec_asr64(v, width > bits ? width - bits : 0);
}

/* a . b where it fits 32 bits, e.g. components of at most 2^14. */
static inline int32_t vec_dot(vec3 a, vec3 b) {
  return fx_add(fx_add(fx_mul(a.x, b.x), fx_mul(a.y, b.y)), fx_mul(a.z, b.z));
}
/* a . b where |a| |b| is below 2^63. */
static inline int64_t vec_dot64(vec3 a, vec3 b) {
  return fx_add64(fx_add64(fx_mul_wide(a.x, b.x), fx_mul_wide(a.y, b.y)), fx_mul_wide(a.z, b.z));
}
/* a x b where it fits 32 bits, e.g. components of at most 2^14. */
static inline vec3 vec_cross(vec3 a, vec3 b) {
  return vec_make(fx_sub(fx_mul(a.y, b.z), fx_mul(a.z, b.y)),
                  fx_sub(fx_mul(a.z, b.x), fx_mul(a.x, b.z)),
                  fx_sub(fx_mul(a.x, b.y), fx_mul(a.y, b.x)));
}
/* a x b; fits for any two vectors without a component -2^31. */
static inline vec64 vec_cross64(vec3 a, vec3 b) {
  const vec64 cross = {fx_add64(fx_mul_wide(a.y, b.z), -fx_mul_wide(a.z, b.y)),
                       fx_add64(fx_mul_wide(a.z, b.x), -fx_mul_wide(a.x, b.z)),
                       fx_add64(fx_mul_wide(a.x, b.y), -fx_mul_wide(a.y, b.x))};
  return cross;
}
/* |v|^2; below 3 * 2^62. */
static inline uint64_t vec_squared(vec3 v) {
  return fx_square(v.x) + fx_square(v.y) + fx_square(v.z);
}

/* a . unit, where unit is Q30: in a's format. Fits: |a . unit| <= |a| < 2^32, saturated. */
static inline int32_t vec_dot_unit(vec3 a, vec3 unit) {
  return fx_saturate(fx_round64(vec_dot64(a, unit), 30));
}
/* unit * length, unit in Q30. */
static inline vec3 vec_scale_unit(vec3 unit, int32_t length) {
  return vec_round64(vec_scale64(unit, length), 30);
}
/* v * factor, where that fits. */
static inline vec3 vec_scale_q15(vec3 v, int32_t factor) { return vec_round64(vec_scale64(v, factor), 15); }
static inline vec3 vec_scale_q16(vec3 v, int32_t factor) { return vec_round64(vec_scale64(v, factor), 16); }
static inline vec3 vec_scale_q24(vec3 v, int32_t factor) { return vec_round64(vec_scale64(v, factor), 24); }
/* a x b of two vectors of one format, in that format, where it fits. */
static inline vec3 vec_cross_q24(vec3 a, vec3 b) { return vec_round64(vec_cross64(a, b), 24); }
static inline vec3 vec_cross_q28(vec3 a, vec3 b) { return vec_round64(vec_cross64(a, b), 28); }
/* unit x v, unit in Q30: in v's format, rounded down. */
static inline vec3 vec_cross_unit(vec3 unit, vec3 v) { return vec_asr64(vec_cross64(unit, v), 30); }
/* The point of the segment from a to b at t, Q15 of 0..1; exactly a and b at its ends. */
static inline vec3 vec_lerp_q15(vec3 a, vec3 b, int32_t t) {
  return vec_add(a, vec_scale_q15(vec_sub(b, a), t));
}

/* v / |v| in Q30, where root is that of vec_squared(v): for callers that need |v| too, fx_root_length(). */
static inline vec3 vec_root_unit(fx_root root, vec3 v) {
  return vec_make(fx_root_unit(root, v.x), fx_root_unit(root, v.y), fx_root_unit(root, v.z));
}
/* |v|, for v that is not 0. */
static inline uint32_t vec_length(vec3 v) { return fx_root_length(fx_rsqrt(vec_squared(v), FX_ROOT_FINE)); }
/* v / |v| in Q30, and |v|, for v that is not 0. */
typedef struct {
  vec3 unit;
  uint32_t length;
} vec_direction;
static inline vec_direction vec_direction_of(vec3 v) {
  const fx_root root = fx_rsqrt(vec_squared(v), FX_ROOT_FINE);
  const vec_direction d = {vec_root_unit(root, v), fx_root_length(root)};
  return d;
}
/* v / |v| in Q30; `otherwise` where v is 0. */
static inline vec3 vec_unit(vec3 v, vec3 otherwise) {
  const uint64_t squared = vec_squared(v);
  return squared == 0 ? otherwise : vec_root_unit(fx_rsqrt(squared, FX_ROOT_FINE), v);
}
/* v, made shorter iff it is longer than `limit`. */
static inline vec3 vec_limited(vec3 v, int32_t limit) {
  const uint64_t squared = vec_squared(v);
  if (squared <= fx_square(limit)) return v;
  return vec_scale_unit(vec_root_unit(fx_rsqrt(squared, FX_ROOT_FINE), v), limit);
}

#endif
