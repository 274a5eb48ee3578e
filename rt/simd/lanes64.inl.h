/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/base/fx.h. Rounding, dot and cross products and roots with 64 bits a lane. */
#ifndef FRAY_SIMD_LANES64_INL_H
#define FRAY_SIMD_LANES64_INL_H

#include "rt/base/fx.h"
#include "rt/simd/spring_lanes.inl.h"

#ifdef LANES_HAVE_64
#ifdef __clang__
#define LANES_UNROLL _Pragma("clang loop unroll(full)")
#else
#define LANES_UNROLL _Pragma("GCC unroll 20") /* or small arrays stay in memory */
#endif

LANES_INLINE lanes64 lanes64_mul(lanes a, lanes b) {
  return lanes64_mul_low(lanes64_words(a), lanes64_words(b));
}
LANES_INLINE lanes64 lanes64_mul_u(lanes a, lanes b) {
  return lanes64_mul_low_u(lanes64_words(a), lanes64_words(b));
}
LANES_INLINE lanes64 lanes64_shr_by(lanes64 v, lanes s) { return lanes64_shr_by64(v, lanes64_from(s)); }
LANES_INLINE lanes64 lanes64_shl_by(lanes64 v, lanes s) { return lanes64_shl_by64(v, lanes64_from(s)); }
LANES_INLINE lane_mask lanes64_negative(lanes64 v) { return lanes_negative(lanes64_high(v)); }
LANES_INLINE lane_mask lanes64_less(lanes64 v, int64_t least) {
  return lanes64_negative(lanes64_sub(v, lanes64_set(least)));
}
LANES_INLINE lane_mask mask_none(void) { return lanes_greater(lanes_set(0), lanes_set(0)); }
LANES_INLINE lanes lanes_abs(lanes v) { return lanes_max(v, lanes_sub(lanes_set(0), v)); }
LANES_INLINE lanes lanes_copy_sign(lanes size, lanes like) {
  return lanes_select(lanes_negative(like), lanes_sub(lanes_set(0), size), size);
}
/* fx_round64 to 32 bits; s is at most 32. */
LANES_INLINE lanes lanes64_round(lanes64 v, unsigned s) {
  const lanes64 half = lanes64_set((int64_t)1 << (s - 1u));
  return lanes64_low(lanes64_shr(lanes64_add(v, lanes64_add(lanes64_sign(v), half)), s));
}
/* The same in the low words; what is above them is not the sign. */
LANES_INLINE lanes64 lanes64_rounded(lanes64 v, unsigned s) {
  const lanes64 half = lanes64_set((int64_t)1 << (s - 1u));
  return lanes64_shr(lanes64_add(v, lanes64_add(lanes64_sign(v), half)), s);
}
/* v >= 0 */
LANES_INLINE lanes64 lanes64_rounded_u(lanes64 v, unsigned s) {
  return lanes64_shr(lanes64_add(v, lanes64_set((int64_t)1 << (s - 1u))), s);
}
LANES_INLINE lanes64 lanes64_dot(const lanes a[3], const lanes b[3]) {
  return lanes64_add(lanes64_add(lanes64_mul(a[0], b[0]), lanes64_mul(a[1], b[1])),
                     lanes64_mul(a[2], b[2]));
}
/* Of low words. */
LANES_INLINE lanes64 lanes64_dot_low(const lanes64 a[3], const lanes64 b[3]) {
  return lanes64_add(lanes64_add(lanes64_mul_low(a[0], b[0]), lanes64_mul_low(a[1], b[1])),
                     lanes64_mul_low(a[2], b[2]));
}
/* (a x b) 2^-bits, rounded. */
LANES_INLINE void lanes64_cross(const lanes a[3], const lanes b[3], unsigned bits, lanes product[3]) {
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) {
    const int m = (n + 1) % 3;
    const int o = (n + 2) % 3;
    product[n] = lanes64_round(lanes64_sub(lanes64_mul(a[m], b[o]), lanes64_mul(a[o], b[m])), bits);
  }
}

typedef struct {
  lanes inverse, h;
} lanes_root;

/* The inverse of fx_rsqrt(n, FX_ROOT_FINE) by n 2^lz, whose high words are its m. Words above are 0. */
LANES_INLINE lanes64 lanes64_inverse_root(lanes64 normal) {
  const lanes64 m = lanes64_shr(normal, 32);
  const lanes64 slope = lanes64_select_negative(normal, lanes64_set(217931629), lanes64_set(616403730));
  const lanes64 from = lanes64_select_negative(normal, lanes64_set(1922456487), lanes64_set(2716337504));
  lanes64 y = lanes64_sub(from, lanes64_shr(lanes64_mul_low_u(m, slope), 30));
  LANES_UNROLL
  for (int step = 0; step < FX_ROOT_FINE; ++step) {
    const lanes64 squared = lanes64_shr(lanes64_mul_low_u(y, y), 31);
    const lanes64 unity = lanes64_shr(lanes64_mul_low_u(m, squared), 30);
    const lanes64 short_of = lanes64_sub(lanes64_set((int64_t)1 << 31), unity);
    y = lanes64_add_words(y, lanes64_shr(lanes64_mul_low(y, short_of), 32));
  }
  return lanes64_min_words_u(y, lanes64_set((int64_t)1 << 31));
}

/* Zeros before the first bit of n, an even number. Undefined where n is 0. */
LANES_INLINE lanes lanes64_zeros(lanes64 n) {
  const lanes high = lanes64_high(n);
  const lanes zero = lanes_set(0);
  const lane_mask has_high = lanes_not_equal(high, zero);
  lanes v = lanes_select(has_high, high, lanes64_low(n));
  lanes up = lanes_select(has_high, zero, lanes_set(32));
  LANES_UNROLL
  for (unsigned s = 16; s > 1; s /= 2u) {
    const lane_mask more = lanes_not_equal(lanes_asr(v, 32u - s), zero);
    v = lanes_select(more, v, lanes_shl(v, s));
    up = lanes_add(up, lanes_select(more, zero, lanes_set((int32_t)s)));
  }
  return up;
}

/* fx_rsqrt(n, FX_ROOT_FINE), with its m in *m. Undefined where n is 0. */
LANES_INLINE lanes_root lanes_rsqrt(lanes64 n, lanes *m) {
  const lanes up = lanes64_zeros(n);
  const lanes64 normal = lanes64_shl_by(n, up);
  *m = lanes64_high(normal);
  return (lanes_root){lanes64_low(lanes64_inverse_root(normal)), lanes_sub(lanes_set(31), lanes_asr(up, 1))};
}

/* fx_root_length() of it, in low words. */
LANES_INLINE lanes64 lanes64_root_length(lanes64 n) {
  const lanes up = lanes64_zeros(n);
  const lanes64 normal = lanes64_shl_by(n, up);
  return lanes64_shr_by(lanes64_mul_low_u(lanes64_shr(normal, 32), lanes64_inverse_root(normal)),
                        lanes_add(lanes_asr(up, 1), lanes_set(30)));
}

LANES_INLINE lanes lanes_unit(lanes_root root, lanes v) {
  const lanes64 product = lanes64_shr_by(lanes64_mul_u(lanes_abs(v), root.inverse), root.h);
  const lanes unit = lanes64_low(lanes64_shr(lanes64_add(product, lanes64_set(1)), 1));
  return lanes_copy_sign(lanes_min(unit, lanes_set(1 << 30)), v);
}

/* fx_root_length() of lanes_rsqrt(n, &m). */
LANES_INLINE lanes lanes_root_length(lanes_root root, lanes m) {
  return lanes64_low(lanes64_shr_by(lanes64_mul_u(m, root.inverse), lanes_sub(lanes_set(61), root.h)));
}
/* v / |v| in Q30, and |v|. Lanes with |v|^2 below `least` join *flat; where v is 0 both are undefined. */
LANES_INLINE lanes lanes_direction(const lanes v[3], int64_t least, lanes unit[3], lane_mask *flat) {
  const lanes64 squared = lanes64_dot(v, v);
  lanes m;
  const lanes_root root = lanes_rsqrt(squared, &m);
  *flat = mask_or(*flat, lanes64_less(squared, least));
  LANES_UNROLL
  for (int n = 0; n < 3; ++n) unit[n] = lanes_unit(root, v[n]);
  return lanes_root_length(root, m);
}
LANES_INLINE lanes lanes_scale_unit(lanes unit, lanes length) {
  return lanes64_round(lanes64_mul(unit, length), 30);
}

/* ORs the magnitude of v (~v below zero) into `far`: its top bit bounds every value seen. */
LANES_INLINE lanes64 lanes64_or_size(lanes64 far, lanes64 v) {
  return lanes64_or(far, lanes64_xor(v, lanes64_sign(v)));
}
/* a b + c d of low words, rounded; its size goes into `far`. */
LANES_INLINE lanes64 lanes64_dot2(lanes64 *far, lanes64 a, lanes64 b, lanes64 c, lanes64 d, unsigned bits) {
  const lanes64 sum = lanes64_add(lanes64_mul_low(a, b), lanes64_mul_low(c, d));
  *far = lanes64_or_size(*far, sum);
  return lanes64_rounded(sum, bits);
}
/* Whether any value seen was outside of +-2^bits. */
LANES_INLINE int lanes64_any_beyond(lanes64 far, unsigned bits) {
  return mask_bits(lanes_not_equal(lanes64_low(lanes64_shr(far, bits)), lanes_set(0))) != 0;
}
#endif

#endif
