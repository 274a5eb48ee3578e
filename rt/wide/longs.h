/* SPDX-License-Identifier: Apache-2.0 */
/* Numbers of 64 bits in lanes: rounded, squared, their roots; as rt/base/fx.h has them. */
#ifndef FRAY_WIDE_LONGS_H
#define FRAY_WIDE_LONGS_H

#include "rt/base/fx.h"
#include "rt/wide/pairs.h"

#ifdef LANES_LONGS
#ifdef __clang__
#define LONGS_UNROLLED _Pragma("clang loop unroll(full)")
#else
#define LONGS_UNROLLED _Pragma("GCC unroll 20") /* or small arrays stay in memory */
#endif

LANES_INLINE lane_mask longs_negative(longs v) { return lanes_below_zero(longs_high(v)); }
LANES_INLINE lane_mask longs_below(longs v, int64_t least) { return longs_negative(longs_sub(v, longs_all(least))); }
LANES_INLINE lanes lanes_size(lanes v) { return lanes_max(v, lanes_sub(lanes_all(0), v)); }
LANES_INLINE lanes lanes_signed(lanes size, lanes like) {
  return lanes_pick(lanes_below_zero(like), lanes_sub(lanes_all(0), size), size);
}
/* fx_round64 to 32 bits; s is at most 32. */
LANES_INLINE lanes longs_round(longs v, unsigned s) {
  const longs half = longs_all((int64_t)1 << (s - 1u));
  return longs_low(longs_shr(longs_add(v, longs_add(longs_sign(v), half)), s));
}
LANES_INLINE longs longs_squared(const lanes v[3]) {
  return longs_add(longs_add(longs_mul(v[0], v[0]), longs_mul(v[1], v[1])), longs_mul(v[2], v[2]));
}
/* The vector product, rounded by so many bits. */
LANES_INLINE void longs_cross(const lanes a[3], const lanes b[3], unsigned bits, lanes product[3]) {
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    const int m = (n + 1) % 3;
    const int o = (n + 2) % 3;
    product[n] = longs_round(longs_sub(longs_mul(a[m], b[o]), longs_mul(a[o], b[m])), bits);
  }
}

typedef struct {
  lanes inverse, h;
} lanes_root;

LANES_INLINE lanes lanes_newton(lanes m, lanes y) {
  const lanes squared = longs_low(longs_shr(longs_mul_u(y, y), 31));
  const lanes unity = longs_low(longs_shr(longs_mul_u(m, squared), 30));
  const lanes short_of = lanes_sub(lanes_all(INT32_MIN), unity);
  return lanes_add(y, longs_high(longs_mul(y, short_of)));
}

/* fx_rsqrt(n, FX_ROOT_FINE); m comes to stand in *m. Anything where n is 0. */
LANES_INLINE lanes_root lanes_rsqrt(longs n, lanes *m) {
  const lanes high = longs_high(n);
  const lanes zero = lanes_all(0);
  const lane_mask has_high = lanes_differ(high, zero);
  lanes v = lanes_pick(has_high, high, longs_low(n));
  lanes up = lanes_pick(has_high, zero, lanes_all(32));
  LONGS_UNROLLED
  for (unsigned s = 16; s > 1; s /= 2u) {
    const lane_mask more = lanes_differ(lanes_asr(v, 32u - s), zero);
    v = lanes_pick(more, v, lanes_shl(v, s));
    up = lanes_add(up, lanes_pick(more, zero, lanes_all((int32_t)s)));
  }
  *m = longs_high(longs_shl_by(n, up));
  const lanes slope_low = longs_low(longs_shr(longs_mul_u(*m, lanes_all(616403730)), 30));
  const lanes slope_high = longs_low(longs_shr(longs_mul_u(*m, lanes_all(217931629)), 30));
  const lanes low = lanes_sub(lanes_all((int32_t)2716337504u), slope_low);
  const lanes high_y = lanes_sub(lanes_all((int32_t)1922456487u), slope_high);
  lanes y = lanes_pick(lanes_below_zero(*m), high_y, low);
  y = lanes_newton(*m, lanes_newton(*m, lanes_newton(*m, y)));
  /* at most 2^31 */
  y = lanes_pick(lanes_below_zero(y), lanes_all(INT32_MIN), y);
  return (lanes_root){y, lanes_sub(lanes_all(31), lanes_asr(up, 1))};
}

LANES_INLINE lanes lanes_unit(lanes_root root, lanes v) {
  const longs product = longs_shr_by(longs_mul_u(lanes_size(v), root.inverse), root.h);
  const lanes unit = longs_low(longs_shr(longs_add(product, longs_all(1)), 1));
  return lanes_signed(lanes_min(unit, lanes_all(1 << 30)), v);
}

/* fx_root_length(), of what lanes_rsqrt() made of n. */
LANES_INLINE lanes lanes_root_length(lanes_root root, lanes m) {
  return longs_low(longs_shr_by(longs_mul_u(m, root.inverse), lanes_sub(lanes_all(61), root.h)));
}
LANES_INLINE lanes lanes_scaled(lanes unit, lanes length) {
  return longs_round(longs_mul(unit, length), 30);
}


/* v, or ~v below zero: what is far from zero in any of what is added up. */
LANES_INLINE longs longs_farther(longs far, longs v) { return longs_or(far, longs_xor(v, longs_sign(v))); }
/* Which of them were not within +-2^bits. */
LANES_INLINE int longs_any_from(longs far, unsigned bits) {
  return lanes_bits(lanes_differ(longs_low(longs_shr(far, bits)), lanes_all(0))) != 0;
}
#endif

#endif
