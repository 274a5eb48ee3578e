/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: fx_divide_wide() in rt/base/fx.h; and divisions bit by bit. */
#ifndef FRAY_SIMD_DIVIDE_LANES_INL_H
#define FRAY_SIMD_DIVIDE_LANES_INL_H

#include "rt/simd/lanes64.inl.h"

#ifdef LANES_HAVE_64
/* d 2^up, which is at least 2^31; d > 0. */
LANES_INLINE lanes lanes_normalise(lanes d, lanes *up) {
  const lanes zero = lanes_set(0);
  lanes v = d;
  *up = zero;
  LANES_UNROLL
  for (unsigned s = 16; s > 0; s /= 2u) {
    const lane_mask high = lanes_not_equal(lanes_asr(v, 32u - s), zero);
    v = lanes_select(high, v, lanes_shl(v, s));
    *up = lanes_add(*up, lanes_select(high, zero, lanes_set((int32_t)s)));
  }
  return v;
}

/* 2^62 / m or slightly less, by Newton's method from a chord that is at most 9 % off. */
LANES_INLINE lanes lanes_inverse(lanes m) {
  lanes y = lanes_sub(lanes_set((int32_t)3129112985u), lanes_and(lanes_asr(m, 1), lanes_set(INT32_MAX)));
  LANES_UNROLL
  for (int step = 0; step < 4; ++step) {
    const lanes unity = lanes64_high(lanes64_mul_u(m, y));
    y = lanes64_low(lanes64_shr(lanes64_mul_u(y, lanes_sub(lanes_set(INT32_MIN), unity)), 30));
  }
  return lanes_sub(y, lanes_set(4));
}

/* n 2^bits / d rounded down, at most INT32_MAX; n >= 0, bits <= 31. INT32_MAX where d is 0. */
LANES_INLINE lanes lanes_ratio(lanes n, unsigned bits, lanes d) {
  lanes up;
  const lanes y = lanes_inverse(lanes_normalise(d, &up));
  const lanes64 whole = lanes64_shl(lanes64_from(n), bits);
  /* the first quotient is low by at most a dozen, the second by one */
  const lanes high = lanes64_low(lanes64_shr(lanes64_shl_by(whole, up), 31));
  const lanes first = lanes64_low(lanes64_shr(lanes64_mul_u(high, y), 31));
  const lanes64 left = lanes64_sub(whole, lanes64_mul_u(first, d));
  const lanes rest = lanes64_low(lanes64_shr(lanes64_shl_by(left, up), 6));
  const lanes second = lanes64_low(lanes64_shr(lanes64_mul_u(rest, y), 56));
  const lanes64 last = lanes64_sub(lanes64_sub(left, lanes64_mul_u(second, d)), lanes64_from(d));
  const lanes quotient =
      lanes_add(lanes_add(first, second), lanes_select(lanes64_negative(last), lanes_set(0), lanes_set(1)));
  const lane_mask fits = lanes_greater(d, lanes64_low(lanes64_shr(whole, 31)));
  return lanes_select(fits, quotient, lanes_set(INT32_MAX));
}

/* n / d rounded down, bit by bit, for `count` independent quotients side by side; d > 0, 0 <= n < d 2^bits
 * and n < 2^31; `bits` at most 31, count at most 4. */
LANES_INLINE void lanes_divide_bits(lanes *n, const lanes *d, unsigned bits, int count, lanes *quotient) {
  lanes missing[4]; /* the quotient's zeros */
  for (int k = 0; k < count; ++k) missing[k] = lanes_set(0);
  LANES_UNROLL
  for (unsigned left = bits; left != 0; --left) {
    const unsigned bit = left - 1u;
    LANES_UNROLL
    for (int k = 0; k < count; ++k) {
      const lanes rest = lanes_sub(n[k], bit == 0 ? d[k] : lanes_shl(d[k], bit));
      n[k] = lanes_min_unsigned(n[k], rest);
      missing[k] = lanes_sub(lanes_add(missing[k], missing[k]), lanes_sign(rest));
    }
  }
  for (int k = 0; k < count; ++k)
    quotient[k] = lanes_sub(lanes_set((int32_t)((1u << bits) - 1u)), missing[k]);
}

/* n / d in Q15, rounded down, for four n; 0 < n <= 2 d. */
LANES_INLINE void lanes_divide_q15(lanes n[4], lanes d, lanes quotient[4]) {
  lanes missing[4];
  for (int k = 0; k < 4; ++k) missing[k] = lanes_set(0);
  LANES_UNROLL
  for (unsigned left = 17; left != 0; --left) {
    const unsigned bit = left - 1u;
    const lanes part = bit > 15 ? lanes_add(d, d) : d;
    LANES_UNROLL
    for (int k = 0; k < 4; ++k) {
      const lanes rest = lanes_sub(n[k], part);
      n[k] = lanes_min_unsigned(n[k], rest);
      missing[k] = lanes_sub(lanes_add(missing[k], missing[k]), lanes_sign(rest));
      if (bit < 16 && bit > 0) n[k] = lanes_add(n[k], n[k]);
    }
  }
  for (int k = 0; k < 4; ++k) quotient[k] = lanes_sub(lanes_set((1 << 17) - 1), missing[k]);
}

/* v >= 0, shifted down to 16 bits; the shift is added to `down`. */
LANES_INLINE lanes lanes_to_16_bits(lanes v, lanes *down) {
  LANES_UNROLL
  for (unsigned s = 8; s != 0; s /= 2u) {
    const lane_mask more = lanes_greater(v, lanes_set((int32_t)(1u << (15u + s)) - 1));
    v = lanes_select(more, lanes_asr(v, s), v);
    *down = lanes_add(*down, lanes_or_zero(more, lanes_set((int32_t)s)));
  }
  return v;
}
#endif

#endif
