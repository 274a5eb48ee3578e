/* SPDX-License-Identifier: Apache-2.0 */
/* Four 32-bit lanes on Armv8.1-M with the vector extension (MVE), little-endian. */
#ifndef FRAY_SIMD_LANES_HELIUM_H
#define FRAY_SIMD_LANES_HELIUM_H

#include <arm_mve.h>

#include "rt/state/spring.h"

enum { LANES = 4, LANES_ALL = 15 };
#define LANES_NO_BROAD_PHASE /* a pass of scalar code is faster */
#define LANES_RUNS_UNROLLED 1
#define LANES_UNROLL_3 _Pragma("GCC unroll 3") /* or small arrays stay in memory */
typedef int32x4_t lanes;
typedef mve_pred16_t lane_mask; /* four equal bits a lane */

#define LANES_INLINE static inline /* always_inline takes three times the code and saves 1 % of the tick */

LANES_INLINE uint32x4_t lanes_to_unsigned(lanes v) { return vreinterpretq_u32_s32(v); }
LANES_INLINE lanes lanes_from_unsigned(uint32x4_t v) { return vreinterpretq_s32_u32(v); }

LANES_INLINE lanes lanes_set(int32_t v) { return vdupq_n_s32(v); }
LANES_INLINE lanes lanes_set_from(const int32_t *v) { return vdupq_n_s32(*v); }
LANES_INLINE lanes lanes_add(lanes a, lanes b) { return vaddq_s32(a, b); }
LANES_INLINE lanes lanes_sub(lanes a, lanes b) { return vsubq_s32(a, b); }
LANES_INLINE lanes lanes_mul(lanes a, lanes b) { return vmulq_s32(a, b); }
LANES_INLINE lanes lanes_min(lanes a, lanes b) { return vminq_s32(a, b); }
LANES_INLINE lanes lanes_max(lanes a, lanes b) { return vmaxq_s32(a, b); }
/* to the left by a signed count: to the right below zero */
LANES_INLINE lanes lanes_asr(lanes v, unsigned s) { return vshlq_r_s32(v, -(int32_t)s); }
LANES_INLINE lanes lanes_shl(lanes v, unsigned s) { return vshlq_r_s32(v, (int32_t)s); }
LANES_INLINE lanes lanes_asr_by(lanes v, lanes s) { return vshlq_s32(v, vnegq_s32(s)); }
LANES_INLINE lanes lanes_shl_by(lanes v, lanes s) { return vshlq_s32(v, s); }
LANES_INLINE lane_mask lanes_greater(lanes a, lanes b) { return vcmpgtq_s32(a, b); }
LANES_INLINE lanes lanes_sign(lanes v) { return vshrq_n_s32(v, 31); }
LANES_INLINE lane_mask lanes_negative(lanes v) { return vcmpltq_n_s32(v, 0); }
LANES_INLINE lanes lanes_select(lane_mask m, lanes yes, lanes no) { return vpselq_s32(yes, no, m); }
LANES_INLINE lanes lanes_or_zero(lane_mask m, lanes v) { return vpselq_s32(v, vdupq_n_s32(0), m); }

LANES_INLINE lane_mask mask_first(uint32_t count) { return vctp32q(count); }
LANES_INLINE uint32_t mask_bits(lane_mask m) {
  const uint32_t apart = m & 0x1111u;
  return (apart | apart >> 3 | apart >> 6 | apart >> 9) & LANES_ALL;
}
LANES_INLINE lane_mask lanes_not_equal(lanes a, lanes b) { return vcmpneq_s32(a, b); }
/* Whether the ids are first, first + 1, ... */
LANES_INLINE int lanes_are_consecutive(lanes ids, index_t first) {
  return vcmpneq_u32(lanes_to_unsigned(ids), vidupq_n_u32(first, 1)) == 0;
}
LANES_INLINE int lanes_all_equal(lanes v, uint32_t to) {
  return vcmpneq_n_s32(v, (int32_t)to) == 0;
}
/* Bit n: id n is not id n - 1 plus 1, for n > 0. */
LANES_INLINE uint32_t lanes_run_starts(lanes ids) {
  uint32_t last = 0;
  const lanes before = vshlcq_s32(ids, &last, 32); /* all bits of a lane to the next */
  return mask_bits(vcmpneq_s32(ids, vaddq_n_s32(before, 1))) & (LANES_ALL - 1);
}
/* Of the lanes in `bits`, those from `first` to `end` - 1. */
LANES_INLINE lane_mask mask_range(uint32_t bits, uint32_t first, uint32_t end) {
  const uint32_t m = bits & ((1u << end) - (1u << first));
  return (lane_mask)((m & 1u) | (m & 2u) << 3 | (m & 4u) << 6 | (m & 8u) << 9) * 15u;
}

LANES_INLINE lanes lanes_gather(const int32_t *from, const uint32_t at[LANES]) {
  return vldrwq_gather_shifted_offset_s32(from, vldrwq_u32(at));
}
LANES_INLINE lanes lanes_load(const int32_t *from) { return vldrwq_s32(from); }
LANES_INLINE void lanes_store(int32_t *to, lanes v) { vstrwq_s32(to, v); }
LANES_INLINE lanes lanes_load_masked(lanes others, const int32_t *from, lane_mask m) {
  return vpselq_s32(vldrwq_z_s32(from, m), others, m);
}
LANES_INLINE void lanes_store_masked(int32_t *to, lane_mask m, lanes v) { vstrwq_p_s32(to, v, m); }
LANES_INLINE lanes lanes_load_ids_first(const index_t *from, uint32_t count) {
#if FRAY_ID_BITS == 16
  return lanes_from_unsigned(vldrhq_z_u32(from, vctp32q(count)));
#else
  return lanes_from_unsigned(vldrwq_z_u32(from, vctp32q(count)));
#endif
}
LANES_INLINE lanes lanes_load_ids(const index_t *from) {
#if FRAY_ID_BITS == 16
  return lanes_from_unsigned(vldrhq_u32(from));
#else
  return lanes_from_unsigned(vldrwq_u32(from));
#endif
}
LANES_INLINE lanes lanes_load_kinds(const uint8_t *from) { return lanes_from_unsigned(vldrbq_u32(from)); }
LANES_INLINE lanes lanes_load_kinds_first(const uint8_t *from, uint32_t count) {
  return lanes_from_unsigned(vldrbq_z_u32(from, vctp32q(count)));
}

#endif
