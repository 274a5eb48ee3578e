/* SPDX-License-Identifier: Apache-2.0 */
/* Fixed point: the one place that shifts, rounds, saturates and multiplies wide.
 *
 *  quantity              format        range         why it fits
 *  position              Q24 lu        +-60 lu       held in predict and collide; differences fit 32 bits
 *  velocity              Q28 lu/sub    +-8 lu        saturated in finish
 *  position remainder    Q28 lu        +-8 LSB       rounding of Q28 to Q24, half away from zero
 *  link direction        Q16 lu        +-1/4 lu      saturated; rest lengths are below 1/8 lu
 *  squared link strain   Q20           -7/16..9/16   clamped, see stage/strain.c
 *  unit vector           Q30           +-1           from fx_rsqrt, error below 2^-28
 *  friction, strain      Q16
 *  gains                 Q28 or stated with the gain
 *
 * No operation here is undefined for any value: sums wrap in two's complement. Shift counts are
 * the caller's: 1 to one less than the width. A build with
 * FRAY_CHECKED traps where a sum or a product leaves its type although it was proved not to.
 * Functions named fx_wrap_* are meant to wrap and never trap. */
#ifndef FRAY_BASE_FX_H
#define FRAY_BASE_FX_H

#include <stdint.h>

#ifdef FRAY_CHECKED
#define FX_CHECK(condition) \
  do { \
    if (!(condition)) __builtin_trap(); \
  } while (0)
#else
#define FX_CHECK(condition) ((void)0)
#endif

/* clang's integer sanitizer flags unsigned wrap-around; here it is meant. */
#if defined(__clang__)
#define FX_WRAPS __attribute__((no_sanitize("integer")))
#else
#define FX_WRAPS
#endif

enum { FX_POSITION_BITS = 24, FX_VELOCITY_BITS = 28, FX_SUB_BITS = 4 };
#define FX_LU ((int32_t)1 << FX_POSITION_BITS)
#define FX_WORLD_MAX (60 * FX_LU)

FX_WRAPS static inline int32_t fx_wrap_add(int32_t a, int32_t b) {
  return (int32_t)((uint32_t)a + (uint32_t)b);
}
FX_WRAPS static inline int32_t fx_wrap_sub(int32_t a, int32_t b) {
  return (int32_t)((uint32_t)a - (uint32_t)b);
}
/* v * 2^s. */
FX_WRAPS static inline int32_t fx_wrap_shift(int32_t v, unsigned s) {
  return (int32_t)((uint32_t)v << s);
}
FX_WRAPS static inline uint32_t fx_wrap_mul_u(uint32_t a, uint32_t b) { return a * b; }

static inline int32_t fx_add(int32_t a, int32_t b) {
  FX_CHECK((int64_t)a + b == fx_wrap_add(a, b));
  return fx_wrap_add(a, b);
}
static inline int32_t fx_sub(int32_t a, int32_t b) {
  FX_CHECK((int64_t)a - b == fx_wrap_sub(a, b));
  return fx_wrap_sub(a, b);
}
FX_WRAPS static inline int32_t fx_mul(int32_t a, int32_t b) {
  const int32_t product = (int32_t)((uint32_t)a * (uint32_t)b);
  FX_CHECK((int64_t)a * b == product);
  return product;
}
static inline int64_t fx_mul_wide(int32_t a, int32_t b) { return (int64_t)a * b; }
FX_WRAPS static inline int64_t fx_add64(int64_t a, int64_t b) {
  const int64_t sum = (int64_t)((uint64_t)a + (uint64_t)b);
  FX_CHECK(((a ^ sum) & (b ^ sum)) >= 0);
  return sum;
}
FX_WRAPS static inline int64_t fx_mul64(int64_t a, int64_t b) {
#ifdef FRAY_CHECKED
  int64_t checked;
  FX_CHECK(!__builtin_mul_overflow(a, b, &checked));
#endif
  return (int64_t)((uint64_t)a * (uint64_t)b);
}

/* Arithmetic shift right (floor), without shifting a negative value; compilers fold it. */
static inline int32_t fx_asr(int32_t v, unsigned s) { return v < 0 ? ~(~v >> s) : v >> s; }
static inline int64_t fx_asr64(int64_t v, unsigned s) { return v < 0 ? ~(~v >> s) : v >> s; }

/* Shift right by s >= 1, round to nearest, halves away from zero: odd-symmetric, so a mirrored
 * input gives the mirrored result. */
static inline int32_t fx_round(int32_t v, unsigned s) {
  return fx_asr(fx_add(v, fx_asr(v, 31) + ((int32_t)1 << (s - 1))), s);
}
static inline int64_t fx_round64(int64_t v, unsigned s) {
  return fx_asr64(fx_add64(v, fx_asr64(v, 63) + ((int64_t)1 << (s - 1))), s);
}
/* Product of two Q15 values (or Q15 and any Qn), rounded half up: one SIMD instruction wide. */
static inline int32_t fx_mul_q15(int32_t a, int32_t b) {
  return fx_asr(fx_add(fx_mul(a, b), 1 << 14), 15);
}

static inline int32_t fx_min(int32_t a, int32_t b) { return a < b ? a : b; }
static inline int32_t fx_max(int32_t a, int32_t b) { return a > b ? a : b; }
static inline int32_t fx_clamp(int32_t v, int32_t low, int32_t high) {
  return v < low ? low : (v > high ? high : v);
}
static inline int64_t fx_clamp64(int64_t v, int64_t low, int64_t high) {
  return v < low ? low : (v > high ? high : v);
}
/* To 32 bits, +-(2^31 - 1): symmetric. */
static inline int32_t fx_saturate(int64_t v) {
  return (int32_t)fx_clamp64(v, -(int64_t)INT32_MAX, INT32_MAX);
}
/* a + b, saturated to +-(2^31 - 1), in 32 bits: a loop of these vectorises. */
static inline int32_t fx_add_saturated(int32_t a, int32_t b) {
  const int32_t sum = fx_wrap_add(a, b);
  const int32_t bound = a < 0 ? -INT32_MAX : INT32_MAX;
  return fx_max(((a ^ sum) & (b ^ sum)) < 0 ? bound : sum, -INT32_MAX);
}
static inline uint32_t fx_magnitude(int32_t v) {
  return v < 0 ? (uint32_t) - (int64_t)v : (uint32_t)v;
}

static inline unsigned fx_leading_zeros64(uint64_t v) { return (unsigned)__builtin_clzll(v); }

/* 1/sqrt(n) and sqrt(n) of a positive 64-bit integer, in normalised form:
 * n = m * 2^(2h - 30) with m in [2^30, 2^32); inverse = 2^46 / sqrt(m) in (2^30, 2^31]. */
typedef struct {
  uint32_t inverse; /* Q31 of 1/sqrt(m / 2^30) */
  uint32_t m;
  unsigned h; /* sqrt(n) = sqrt(m / 2^30) * 2^h */
} fx_root;

/* Newton steps from a chord in two pieces (2.4% off at worst): relative error below 2^-28 after
 * three (FX_ROOT_FINE), 2^-19 after two (FX_ROOT_COARSE), measured in tests/unit. n >= 1. */
enum { FX_ROOT_COARSE = 2, FX_ROOT_FINE = 3 };
static inline fx_root fx_rsqrt(uint64_t n, int steps) {
  const unsigned lz = fx_leading_zeros64(n) & ~1u;
  fx_root r;
  r.m = (uint32_t)((n << lz) >> 32);
  r.h = 31u - (lz >> 1);
  uint64_t y = r.m < 0x80000000u ? 2716337504u - (((uint64_t)r.m * 616403730u) >> 30)
                                 : 1922456487u - (((uint64_t)r.m * 217931629u) >> 30);
  for (int step = 0; step < steps; ++step) {
    const uint64_t squared = (y * y) >> 31;
    const uint64_t unity = ((uint64_t)r.m * squared) >> 30; /* m * y * y in Q31, near 1 */
    y = (y * (3u * (uint64_t)0x80000000u - unity)) >> 32;
  }
  r.inverse = (uint32_t)(y > 0x80000000u ? 0x80000000u : y);
  return r;
}
/* sqrt(n) rounded down to within its relative error; below 2^32. */
static inline uint32_t fx_root_length(fx_root r) {
  const uint64_t root_q61 = (uint64_t)r.m * r.inverse;
  return (uint32_t)(root_q61 >> (61u - r.h));
}
/* v / sqrt(n) in Q30, for |v| <= sqrt(n): one component of the unit vector. */
static inline int32_t fx_root_unit(fx_root r, int32_t v) {
  const int64_t unit = fx_round64(fx_mul64(v, (int64_t)r.inverse), r.h + 1u);
  return (int32_t)fx_clamp64(unit, -((int64_t)1 << 30), (int64_t)1 << 30);
}

#endif
