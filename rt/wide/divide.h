/* SPDX-License-Identifier: Apache-2.0 */
/* Quotients in lanes, exactly those of fx_divide_wide(). */
#ifndef FRAY_WIDE_DIVIDE_H
#define FRAY_WIDE_DIVIDE_H

#include "rt/wide/longs.h"

#ifdef LANES_LONGS
/* d times 2^up is at least 2^31. */
LANES_INLINE lanes lanes_normal(lanes d, lanes *up) {
  const lanes zero = lanes_all(0);
  lanes v = d;
  *up = zero;
  LONGS_UNROLLED
  for (unsigned s = 16; s > 0; s /= 2u) {
    const lane_mask high = lanes_differ(lanes_asr(v, 32u - s), zero);
    v = lanes_pick(high, v, lanes_shl(v, s));
    *up = lanes_add(*up, lanes_pick(high, zero, lanes_all((int32_t)s)));
  }
  return v;
}

/* 2^62 / m, or a little less: Newton's from a chord that is 9 % off at worst. */
LANES_INLINE lanes lanes_inverse(lanes m) {
  lanes y = lanes_sub(lanes_all((int32_t)3129112985u), lanes_and(lanes_asr(m, 1), lanes_all(INT32_MAX)));
  LONGS_UNROLLED
  for (int step = 0; step < 4; ++step) {
    const lanes unity = longs_high(longs_mul_u(m, y));
    y = longs_low(longs_shr(longs_mul_u(y, lanes_sub(lanes_all(INT32_MIN), unity)), 30));
  }
  return lanes_sub(y, lanes_all(4));
}

/* n 2^bits / d rounded down, at most INT32_MAX; for n from 0, d from 1, bits at most 31. Anything where d is 0. */
LANES_INLINE lanes lanes_ratio(lanes n, unsigned bits, lanes d) {
  lanes up;
  const lanes y = lanes_inverse(lanes_normal(d, &up));
  const longs whole = longs_shl(longs_of(n), bits);
  /* too low by a dozen, then by one */
  const lanes high = longs_low(longs_shr(longs_shl_by(whole, up), 31));
  const lanes first = longs_low(longs_shr(longs_mul_u(high, y), 31));
  const longs left = longs_sub(whole, longs_mul_u(first, d));
  const lanes rest = longs_low(longs_shr(longs_shl_by(left, up), 6));
  const lanes second = longs_low(longs_shr(longs_mul_u(rest, y), 56));
  const longs last = longs_sub(longs_sub(left, longs_mul_u(second, d)), longs_of(d));
  const lanes quotient = lanes_add(lanes_add(first, second), lanes_pick(longs_negative(last), lanes_all(0), lanes_all(1)));
  const lane_mask fits = lanes_above(d, longs_low(longs_shr(whole, 31)));
  return lanes_pick(fits, quotient, lanes_all(INT32_MAX));
}
#endif

#endif
