/* SPDX-License-Identifier: Apache-2.0 */
/* Fixed point of 128 bits: 64 before the point and 64 behind it, for sums that must not round. Sums
 * wrap in two's complement. No compiler's 128-bit type, which 32-bit machines lack. */
#ifndef FRAY_BASE_WIDE_H
#define FRAY_BASE_WIDE_H

#include "rt/base/fx.h"

/* whole + part / 2^64 */
typedef struct {
  int64_t whole;
  uint64_t part;
} wide_number;

FX_WRAPS static inline wide_number wide_add(wide_number a, wide_number b) {
  const uint64_t part = a.part + b.part;
  const wide_number sum = {(int64_t)((uint64_t)a.whole + (uint64_t)b.whole + (part < a.part)),
                           part};
  return sum;
}
FX_WRAPS static inline wide_number wide_negated(wide_number a) {
  const wide_number n = {(int64_t)(~(uint64_t)a.whole + (a.part == 0)), ~a.part + 1u};
  return n;
}
static inline wide_number wide_sub(wide_number a, wide_number b) {
  return wide_add(a, wide_negated(b));
}
static inline int wide_is_negative(wide_number a) { return a.whole < 0; }

/* v 2^s; s: 0..63. Bits above are lost. */
FX_WRAPS static inline wide_number wide_shift_up(wide_number v, unsigned s) {
  if (s == 0) return v;
  const wide_number up = {(int64_t)((uint64_t)v.whole << s | v.part >> (64u - s)), v.part << s};
  return up;
}
/* v 2^-s, rounded down; s: 0..127. */
FX_WRAPS static inline wide_number wide_shift_down(wide_number v, unsigned s) {
  if (s == 0) return v;
  if (s >= 64u) {
    const wide_number low = {fx_asr64(v.whole, 63), (uint64_t)fx_asr64(v.whole, s - 64u)};
    return low;
  }
  const wide_number down = {fx_asr64(v.whole, s), (uint64_t)v.whole << (64u - s) | v.part >> s};
  return down;
}

/* a b 2^-bits, rounded down; bits: 1..191, of 64 or less where the product fits. */
FX_WRAPS static inline wide_number wide_product(int64_t a, int64_t b, unsigned bits) {
  const uint64_t x = a < 0 ? ~(uint64_t)a + 1u : (uint64_t)a;
  const uint64_t y = b < 0 ? ~(uint64_t)b + 1u : (uint64_t)b;
  const uint64_t low = fx_mul_wide_u((uint32_t)x, (uint32_t)y);
  const uint64_t cross = fx_mul_wide_u((uint32_t)(x >> 32), (uint32_t)y) + (low >> 32);
  const uint64_t middle = fx_mul_wide_u((uint32_t)x, (uint32_t)(y >> 32)) + (uint32_t)cross;
  const uint64_t high =
      fx_mul_wide_u((uint32_t)(x >> 32), (uint32_t)(y >> 32)) + (cross >> 32) + (middle >> 32);
  const wide_number magnitude = {(int64_t)high,
                                 middle << 32 | (uint32_t)low}; /* below 2^126 of 2^-64 */
  const wide_number product = (a < 0) != (b < 0) ? wide_negated(magnitude) : magnitude;
  return bits >= 64u ? wide_shift_down(product, bits - 64u) : wide_shift_up(product, 64u - bits);
}
/* v 2^-bits; bits: 1..63. */
FX_WRAPS static inline wide_number wide_of(int64_t v, unsigned bits) {
  const wide_number a = {fx_asr64(v, bits), (uint64_t)v << (64u - bits)};
  return a;
}
/* v times a number of `bits` behind the point, rounded down twice. */
static inline wide_number wide_times(wide_number v, int64_t by, unsigned bits) {
  return wide_add(wide_product(v.whole, by, bits),
                  wide_product((int64_t)(v.part >> 1), by, bits + 63u));
}
/* v / n, towards zero; n: 1..2^31 - 1. */
FX_WRAPS static inline wide_number wide_over(wide_number v, uint32_t n) {
  const int negative = wide_is_negative(v);
  const wide_number a = negative ? wide_negated(v) : v;
  const uint64_t whole = (uint64_t)a.whole;
  const uint64_t high = whole % n << 32 | a.part >> 32;
  const uint64_t low = high % n << 32 | (uint32_t)a.part;
  const wide_number q = {(int64_t)(whole / n), (high / n) << 32 | low / n};
  return negative ? wide_negated(q) : q;
}
/* In steps of 2^-bits, to nearest, saturated; bits: 1..62. */
FX_WRAPS static inline int64_t wide_rounded(wide_number v, unsigned bits) {
  const wide_number half = {0, (uint64_t)1 << (63u - bits)};
  const wide_number sum = wide_add(v, half);
  const int64_t most = (int64_t)1 << (62u - bits);
  if (sum.whole >= most) return INT64_MAX;
  if (sum.whole < -most) return -INT64_MAX;
  return (int64_t)((uint64_t)sum.whole << bits | sum.part >> (64u - bits));
}

#endif
