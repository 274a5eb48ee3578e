/* SPDX-License-Identifier: Apache-2.0 */
/* Fixed point: shifts, rounding, saturation and wide products, all in one place.
 *
 *  quantity              format        range         why it fits
 *  position              Q24 lu        +-60 lu       clamped in integrate and contact, +-62 lu between ticks;
 *                                                      differences fit 32 bits
 *  velocity              Q28 lu/sub    +-8 lu        saturated in velocity_update
 *  position remainder    Q28 lu        +-8 LSB       rounding of Q28 to Q24, half away from zero
 *  link direction        Q16 lu        +-1/4 lu      saturated; rest lengths are below 1/8 lu
 *  squared link strain   Q20           -7/16..9/16   clamped, see woven/strain_limit.c
 *  unit vector           Q30           +-1           from fx_rsqrt, error below 2^-28
 *  friction, strain      Q16
 *  gains                 Q28 or stated with the gain
 *
 * No operation is undefined for any value: sums wrap in two's complement. Shift counts are 0 to one less
 * than the width, of fx_round() at least 1. A build with FRAY_CHECKED traps on other counts, and where a sum
 * or a product overflows that was proved to fit. Functions named fx_wrap_* wrap by design and never trap. */
#ifndef FRAY_BASE_FX_H
#define FRAY_BASE_FX_H

#include <stdint.h>

#include "rt/base/assert.h"

/* In every sum and shift: with FRAY_CHECKED alone. */
#ifdef FRAY_CHECKED
#define FX_ASSERT(condition) FRAY_ASSERT(condition)
#else
#define FX_ASSERT(condition) ((void)sizeof((condition) ? 1 : 0))
#endif

/* clang's integer sanitizer flags unsigned wrap-around, which is intended here. */
#if defined(__clang__)
#define FX_WRAPS __attribute__((no_sanitize("integer")))
#else
#define FX_WRAPS
#endif

/* On in-order cores a rare case is cheapest behind a branch; on out-of-order cores a select lets the loop
 * vectorise. The results are the same. */
#ifndef FX_NARROW
#if (defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M') || \
    (defined(__riscv_xlen) && __riscv_xlen == 32)
#define FX_NARROW 1
#else
#define FX_NARROW 0
#endif
#endif

#ifndef FX_NO_LONG_MULTIPLY
#if defined(__ARM_ARCH) && __ARM_ARCH == 6 && defined(__thumb__) && !defined(__thumb2__)
#define FX_NO_LONG_MULTIPLY 1
#else
#define FX_NO_LONG_MULTIPLY 0
#endif
#endif

/* A 32 x 32-bit product is added to a 64-bit sum by one instruction. */
#ifndef FX_LONG_ACCUMULATE
#if defined(__ARM_ARCH_PROFILE) && __ARM_ARCH_PROFILE == 'M' && !FX_NO_LONG_MULTIPLY
#define FX_LONG_ACCUMULATE 1
#else
#define FX_LONG_ACCUMULATE 0
#endif
#endif

enum { FX_POSITION_BITS = 24, FX_VELOCITY_BITS = 28, FX_SUB_BITS = 4 };
#define FX_LU ((int32_t)1 << FX_POSITION_BITS)
#define FX_WORLD_MAX (60 * FX_LU)
/* Projections and pushes go on past the edge of the world, to here: differences still fit 32 bits. */
#define FX_EDGE_MAX (62 * FX_LU)

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
FX_WRAPS static inline int32_t fx_wrap_mul(int32_t a, int32_t b) {
  return (int32_t)((uint32_t)a * (uint32_t)b);
}
FX_WRAPS static inline uint32_t fx_wrap_mul_u(uint32_t a, uint32_t b) { return a * b; }

/* Arithmetic shift right (floor), without shifting a negative value; compilers fold it. */
static inline int32_t fx_asr(int32_t v, unsigned s) { return v < 0 ? ~(~v >> s) : v >> s; }
static inline int64_t fx_asr64(int64_t v, unsigned s) { return v < 0 ? ~(~v >> s) : v >> s; }

static inline int32_t fx_add(int32_t a, int32_t b) {
  FX_ASSERT((int64_t)a + b == fx_wrap_add(a, b));
  return fx_wrap_add(a, b);
}
static inline int32_t fx_sub(int32_t a, int32_t b) {
  FX_ASSERT((int64_t)a - b == fx_wrap_sub(a, b));
  return fx_wrap_sub(a, b);
}
FX_WRAPS static inline int32_t fx_mul(int32_t a, int32_t b) {
  const int32_t product = (int32_t)((uint32_t)a * (uint32_t)b);
  FX_ASSERT((int64_t)a * b == product);
  return product;
}
/* Full 64-bit products of 32-bit factors. Armv6-M has no instruction for them, and its library multiplies
 * 64 bits by 64. */
FX_WRAPS static inline uint64_t fx_mul_wide_u(uint32_t a, uint32_t b) {
#if FX_NO_LONG_MULTIPLY
  const uint32_t a0 = a & 0xFFFFu;
  const uint32_t a1 = a >> 16;
  const uint32_t b0 = b & 0xFFFFu;
  const uint32_t b1 = b >> 16;
  const uint32_t low = a0 * b0;
  const uint32_t middle = a1 * b0 + (low >> 16); /* below 2^32 */
  const uint32_t cross = a0 * b1 + (middle & 0xFFFFu);
  const uint32_t high = a1 * b1 + (middle >> 16) + (cross >> 16);
  return (uint64_t)high << 32 | (cross << 16 | (low & 0xFFFFu));
#else
  return (uint64_t)a * b;
#endif
}
FX_WRAPS static inline int64_t fx_mul_wide(int32_t a, int32_t b) {
#if FX_NO_LONG_MULTIPLY
  /* upper halves are signed; every sum is within 2^31 */
  const int32_t a0 = a & 0xFFFF;
  const int32_t a1 = fx_asr(a, 16);
  const int32_t b0 = b & 0xFFFF;
  const int32_t b1 = fx_asr(b, 16);
  const uint32_t low = (uint32_t)a0 * (uint32_t)b0;
  const int32_t middle = a1 * b0 + (int32_t)(low >> 16);
  const int32_t cross = a0 * b1 + (middle & 0xFFFF);
  const int32_t high = a1 * b1 + fx_asr(middle, 16) + fx_asr(cross, 16);
  return (int64_t)((uint64_t)(uint32_t)high << 32 | ((uint32_t)cross << 16 | (low & 0xFFFFu)));
#else
  return (int64_t)a * b;
#endif
}
static inline uint32_t fx_magnitude(int32_t v) {
  return v < 0 ? (uint32_t) - (int64_t)v : (uint32_t)v;
}
FX_WRAPS static inline uint64_t fx_square(int32_t v) {
#if FX_NO_LONG_MULTIPLY
  const uint32_t low = (uint32_t)v & 0xFFFFu;
  const int32_t high = fx_asr(v, 16);
  return ((uint64_t)(uint32_t)(high * high) << 32 | low * low) +
         ((uint64_t)(int64_t)(high * (int32_t)low) << 17);
#else
  return (uint64_t)fx_mul_wide(v, v);
#endif
}
FX_WRAPS static inline int64_t fx_add64(int64_t a, int64_t b) {
  const int64_t sum = (int64_t)((uint64_t)a + (uint64_t)b);
  FX_ASSERT(((a ^ sum) & (b ^ sum)) >= 0);
  return sum;
}
FX_WRAPS static inline int64_t fx_mul64(int64_t a, int64_t b) {
#ifdef FRAY_CHECKED
  int64_t checked;
  FX_ASSERT(!__builtin_mul_overflow(a, b, &checked));
#endif
  return (int64_t)((uint64_t)a * (uint64_t)b);
}

/* Shift right by s >= 1, round to nearest, halves away from zero: odd-symmetric, so a mirrored
 * input gives the mirrored result. */
static inline int32_t fx_round(int32_t v, unsigned s) {
  FX_ASSERT(s >= 1 && s < 32);
  return fx_asr(fx_add(v, fx_asr(v, 31) + ((int32_t)1 << (s - 1))), s);
}
static inline int64_t fx_round64(int64_t v, unsigned s) {
  FX_ASSERT(s >= 1 && s < 64);
  return fx_asr64(fx_add64(v, fx_asr64(v, 63) + ((int64_t)1 << (s - 1))), s);
}
/* Product of two Q15 values (or Q15 and any Qn), rounded half up: one SIMD instruction wide. */
static inline int32_t fx_mul_q15(int32_t a, int32_t b) {
  return fx_asr(fx_add(fx_mul(a, b), 1 << 14), 15);
}

/* The largest velocity, Q28 lu per substep: 4 lu in a substep. */
enum { FX_SPEED_MAX = 1 << 30 };
/* What stages may add up to within a substep, before it is limited to that: projections add to it. */
enum { FX_SPEED_OVER = FX_SPEED_MAX / 4 * 5 };

static inline int32_t fx_min(int32_t a, int32_t b) { return a < b ? a : b; }
static inline int32_t fx_max(int32_t a, int32_t b) { return a > b ? a : b; }
static inline int32_t fx_clamp(int32_t v, int32_t low, int32_t high) {
  FX_ASSERT(low <= high);
  return v < low ? low : (v > high ? high : v);
}
static inline int64_t fx_clamp64(int64_t v, int64_t low, int64_t high) {
  FX_ASSERT(low <= high);
  return v < low ? low : (v > high ? high : v);
}
/* Saturates to 16 bits; the intrinsic, because compilers do not always find the instruction. */
static inline int32_t fx_saturate16(int32_t v) {
#ifdef __ARM_FEATURE_SAT
  return (int32_t)__builtin_arm_ssat(v, 16);
#else
  return fx_clamp(v, INT16_MIN, INT16_MAX);
#endif
}
/* fx_clamp() for a value that is almost never outside. */
static inline int32_t fx_clamp_rare(int32_t v, int32_t low, int32_t high) {
#if FX_NARROW
  const uint32_t above = (uint32_t)fx_wrap_sub(v, low);
  if (__builtin_expect(above <= (uint32_t)fx_wrap_sub(high, low), 1)) return v;
#endif
  return fx_clamp(v, low, high);
}
/* To +-limit, in 32 bits; almost never outside. Narrow cores clamp words: where gcc sees a clamp of 64 bits,
 * it multiplies 64 by 64 bits with the result. */
static inline int32_t fx_clamp_wide(int64_t v, int32_t limit) {
#if FX_NARROW
  const int32_t high = (int32_t)fx_asr64(v, 32);
  int32_t word = (int32_t)v;
  if (__builtin_expect(high != fx_asr(word, 31), 0)) word = fx_asr(high, 31) ^ INT32_MAX;
  return fx_clamp_rare(word, -limit, limit);
#else
  return (int32_t)fx_clamp64(v, -(int64_t)limit, limit);
#endif
}
/* Saturates to +-(2^31 - 1), symmetric. */
static inline int32_t fx_saturate(int64_t v) { return fx_clamp_wide(v, INT32_MAX); }
/* a b 2^-s to the nearest, where that fits; and saturated. */
static inline int32_t fx_mul_round(int32_t a, int32_t b, unsigned s) {
  return (int32_t)fx_round64(fx_mul_wide(a, b), s);
}
static inline int32_t fx_mul_saturated(int32_t a, int32_t b, unsigned s) {
  return fx_saturate(fx_round64(fx_mul_wide(a, b), s));
}
/* a + b, saturated to +-(2^31 - 1), in 32 bits. */
static inline int32_t fx_add_saturated(int32_t a, int32_t b) {
  const int32_t sum = fx_wrap_add(a, b);
#if FX_NARROW
  int32_t same;
  const int32_t sign = fx_asr(a, 31);
  if (__builtin_expect(__builtin_add_overflow(a, b, &same), 0)) return (sign ^ INT32_MAX) - sign;
  return __builtin_expect(sum == INT32_MIN, 0) ? -INT32_MAX : sum;
#else
  const int32_t bound = a < 0 ? -INT32_MAX : INT32_MAX;
  return fx_max(((a ^ sum) & (b ^ sum)) < 0 ? bound : sum, -INT32_MAX);
#endif
}

#if FX_NO_LONG_MULTIPLY
/* One step of a restoring division: the quotient bit replaces the used bit of n. Six instructions. */
FX_WRAPS static inline uint64_t fx_divide_bit(uint64_t n, uint32_t d) {
  const uint64_t twice = n + n;
  if ((uint32_t)(twice >> 32) < d) return twice;
  return twice + (1u - ((uint64_t)d << 32));
}

/* n / d for d up to 2^31, saturated to 32 bits (d = 0 too): bit by bit, for cores without a divide
 * instruction. */
FX_WRAPS static inline uint32_t fx_divide_wide(uint64_t n, uint32_t d) {
  FX_ASSERT(d <= 1u << 31);
  if ((uint32_t)(n >> 32) >= d) return UINT32_MAX;
  uint64_t rest = n;
  for (unsigned eight = 0; eight < 4; ++eight) {
    rest = fx_divide_bit(fx_divide_bit(rest, d), d);
    rest = fx_divide_bit(fx_divide_bit(rest, d), d);
    rest = fx_divide_bit(fx_divide_bit(rest, d), d);
    rest = fx_divide_bit(fx_divide_bit(rest, d), d);
  }
  return (uint32_t)rest;
}
#elif UINTPTR_MAX > 0xFFFFFFFFu
/* n / d for d up to 2^31, saturated to 32 bits (d = 0 too). */
static inline uint32_t fx_divide_wide(uint64_t n, uint32_t d) {
  FX_ASSERT(d <= 1u << 31);
  return (uint32_t)(n >> 32) >= d ? UINT32_MAX : (uint32_t)(n / d);
}
#else
/* n / d for d up to 2^31, saturated to 32 bits (d = 0 too): two digits of 16 bits, each estimated from
 * the upper half of the divisor and at most two too large. */
FX_WRAPS static inline uint32_t fx_divide_wide(uint64_t n, uint32_t d) {
  FX_ASSERT(d <= 1u << 31);
  if ((uint32_t)(n >> 32) >= d) return UINT32_MAX;
  const unsigned up = (unsigned)__builtin_clz(d);
  const uint32_t divisor = d << up;
  const uint32_t high = divisor >> 16;
  uint32_t low = (uint32_t)n;
  uint32_t rest = (uint32_t)(n >> 32) << up | low >> 1 >> (31u - up);
  uint32_t quotient = 0;
  low <<= up;
  for (unsigned digit = 0; digit < 2; ++digit) {
    const uint32_t next = low >> 16;
    low <<= 16;
    uint32_t q = rest / high;
    uint32_t left = rest - q * high;
    /* corrected by the lower half of the divisor */
    while (left < 0x10000u && (q > 0xFFFFu || q * (divisor & 0xFFFFu) > (left << 16 | next))) {
      --q;
      left += high;
    }
    rest = (rest << 16 | next) - q * divisor;
    quotient = quotient << 16 | q;
  }
  return quotient;
}
#endif

static inline unsigned fx_leading_zeros64(uint64_t v) { return (unsigned)__builtin_clzll(v); }

/* 1/sqrt(n) and sqrt(n) of a positive 64-bit integer, in normalised form:
 * n = m * 2^(2h - 30) with m in [2^30, 2^32); inverse = 2^46 / sqrt(m) in (2^30, 2^31]. */
typedef struct {
  uint32_t inverse; /* Q31 of 1/sqrt(m / 2^30) */
  uint32_t m;
  unsigned h; /* sqrt(n) = sqrt(m / 2^30) * 2^h */
} fx_root;

/* Newton steps from a chord in two pieces (at most 2.4 % off): relative error below 2^-28 after
 * three (FX_ROOT_FINE), 2^-19 after two (FX_ROOT_COARSE), measured in tests/unit. n >= 1. */
enum { FX_ROOT_COARSE = 2, FX_ROOT_FINE = 3 };
FX_WRAPS static inline fx_root fx_rsqrt(uint64_t n, int steps) {
  FX_ASSERT(n >= 1 && steps >= FX_ROOT_COARSE && steps <= FX_ROOT_FINE);
  const unsigned lz = fx_leading_zeros64(n) & ~1u;
  fx_root r;
  r.m = (uint32_t)((n << lz) >> 32);
  r.h = 31u - (lz >> 1);
  uint32_t y = r.m < 0x80000000u ? 2716337504u - (uint32_t)(fx_mul_wide_u(r.m, 616403730u) >> 30)
                                 : 1922456487u - (uint32_t)(fx_mul_wide_u(r.m, 217931629u) >> 30);
  for (int step = 0; step < steps; ++step) {
    const uint32_t squared = (uint32_t)(fx_mul_wide_u(y, y) >> 31);
    const uint32_t unity = (uint32_t)(fx_mul_wide_u(r.m, squared) >> 30); /* m * y * y in Q31 */
    /* y * (3 - unity) / 2, where y is below 1 before each step */
    const int32_t short_of = (int32_t)(0x80000000u - unity);
    y += (uint32_t)fx_asr64(fx_mul_wide((int32_t)y, short_of), 32);
  }
  r.inverse = y > 0x80000000u ? 0x80000000u : y;
  return r;
}
/* sqrt(n) rounded down to within its relative error; below 2^32. */
static inline uint32_t fx_root_length(fx_root r) {
  FX_ASSERT(r.h <= 31);
  const uint64_t root_q61 = fx_mul_wide_u(r.m, r.inverse);
  return (uint32_t)(root_q61 >> (61u - r.h));
}
/* v 2^bits / sqrt(n), rounded; bits is at most 30. */
FX_WRAPS static inline int64_t fx_root_over(fx_root r, int32_t v, unsigned bits) {
  FX_ASSERT(r.h <= 31 && r.inverse >= 1u << 30 && r.inverse <= 1u << 31 && bits <= 30);
  /* inverse is above 2^30: with 2^31 taken off it fits a signed word */
  const int64_t product =
      fx_mul_wide(v, (int32_t)(r.inverse - 0x80000000u)) + (int64_t)v * ((int64_t)1 << 31);
  return fx_round64(product, r.h + 31u - bits);
}
/* v / sqrt(n) in Q30, for |v| <= sqrt(n): one component of the unit vector. */
static inline int32_t fx_root_unit(fx_root r, int32_t v) {
  return (int32_t)fx_clamp64(fx_root_over(r, v, 30), -((int64_t)1 << 30), (int64_t)1 << 30);
}

#endif
