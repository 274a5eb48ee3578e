/* SPDX-License-Identifier: Apache-2.0 */
/* Four 32-bit lanes on aarch64, little-endian. */
#ifndef FRAY_SIMD_LANES_NEON_H
#define FRAY_SIMD_LANES_NEON_H

#include <arm_neon.h>

#include "rt/base/bytes.h"
#include "rt/state/spring.h"

enum { LANES = 4, LANES_ALL = 15 };
#define LANES_RUNS_UNROLLED 1
typedef int32x4_t lanes;
typedef int32x4_t lane_mask; /* all ones or all zeros a lane */

#define LANES_INLINE static inline __attribute__((always_inline))

LANES_INLINE uint32x4_t lanes_to_unsigned(lanes v) { return vreinterpretq_u32_s32(v); }
LANES_INLINE lanes lanes_from_unsigned(uint32x4_t v) { return vreinterpretq_s32_u32(v); }

LANES_INLINE lanes lanes_set(int32_t v) { return vdupq_n_s32(v); }
LANES_INLINE lanes lanes_set_from(const int32_t *v) { return vld1q_dup_s32(v); }
LANES_INLINE lanes lanes_add(lanes a, lanes b) { return vaddq_s32(a, b); }
LANES_INLINE lanes lanes_sub(lanes a, lanes b) { return vsubq_s32(a, b); }
LANES_INLINE lanes lanes_mul(lanes a, lanes b) { return vmulq_s32(a, b); }
LANES_INLINE lanes lanes_min(lanes a, lanes b) { return vminq_s32(a, b); }
LANES_INLINE lanes lanes_max(lanes a, lanes b) { return vmaxq_s32(a, b); }
/* to the left by a signed count: to the right below zero */
LANES_INLINE lanes lanes_asr(lanes v, unsigned s) { return vshlq_s32(v, vdupq_n_s32(-(int32_t)s)); }
LANES_INLINE lanes lanes_shl(lanes v, unsigned s) { return vshlq_s32(v, vdupq_n_s32((int32_t)s)); }
LANES_INLINE lanes lanes_asr_by(lanes v, lanes s) { return vshlq_s32(v, vnegq_s32(s)); }
LANES_INLINE lanes lanes_shl_by(lanes v, lanes s) { return vshlq_s32(v, s); }
LANES_INLINE lane_mask lanes_greater(lanes a, lanes b) { return lanes_from_unsigned(vcgtq_s32(a, b)); }
LANES_INLINE lanes lanes_sign(lanes v) { return vshrq_n_s32(v, 31); }
LANES_INLINE lane_mask lanes_negative(lanes v) { return vshrq_n_s32(v, 31); }
LANES_INLINE lanes lanes_select(lane_mask m, lanes yes, lanes no) {
  return vbslq_s32(lanes_to_unsigned(m), yes, no);
}
LANES_INLINE lanes lanes_or_zero(lane_mask m, lanes v) { return vandq_s32(m, v); }

LANES_INLINE lanes lanes_lane_bits(void) {
  static const int32_t weights[LANES] = {1, 2, 4, 8};
  return vld1q_s32(weights);
}
LANES_INLINE lane_mask mask_first(uint32_t count) {
  return lanes_from_unsigned(vtstq_s32(vdupq_n_s32((1 << count) - 1), lanes_lane_bits()));
}
LANES_INLINE uint32_t mask_bits(lane_mask m) {
  return (uint32_t)vaddvq_s32(vandq_s32(m, lanes_lane_bits()));
}
LANES_INLINE lane_mask lanes_not_equal(lanes a, lanes b) {
  return vmvnq_s32(vreinterpretq_s32_u32(vceqq_s32(a, b)));
}
/* Whether the ids are first, first + 1, ... */
LANES_INLINE int lanes_are_consecutive(lanes ids, index_t first) {
  static const int32_t numbers[LANES] = {0, 1, 2, 3};
  const lanes run = vaddq_s32(vld1q_s32(numbers), vdupq_n_s32((int32_t)first));
  return vminvq_u32(vceqq_s32(ids, run)) != 0;
}
LANES_INLINE int lanes_all_equal(lanes v, uint32_t to) {
  return vminvq_u32(vceqq_s32(v, vdupq_n_s32((int32_t)to))) != 0;
}
/* Bit n: id n is not id n - 1 plus 1, for n > 0. */
LANES_INLINE uint32_t lanes_run_starts(lanes ids) {
  const lanes next = vaddq_s32(vextq_s32(ids, ids, 3), vdupq_n_s32(1));
  return mask_bits(lanes_not_equal(ids, next)) & (LANES_ALL - 1);
}
/* Of the lanes in `bits`, those from `first` to `end` - 1. */
LANES_INLINE lane_mask mask_range(uint32_t bits, uint32_t first, uint32_t end) {
  const uint32_t m = bits & ((1u << end) - (1u << first));
  return lanes_from_unsigned(vtstq_s32(vdupq_n_s32((int32_t)m), lanes_lane_bits()));
}

LANES_INLINE lanes lanes_gather(const int32_t *from, const uint32_t at[LANES]) {
  lanes v = vld1q_dup_s32(from + at[0]);
  v = vld1q_lane_s32(from + at[1], v, 1);
  v = vld1q_lane_s32(from + at[2], v, 2);
  return vld1q_lane_s32(from + at[3], v, 3);
}
LANES_INLINE lanes lanes_load(const int32_t *from) { return vld1q_s32(from); }
LANES_INLINE void lanes_store(int32_t *to, lanes v) { vst1q_s32(to, v); }
LANES_INLINE lanes lanes_load_ids(const index_t *from) {
#if FRAY_ID_BITS == 16
  return lanes_from_unsigned(vmovl_u16(vld1_u16(from)));
#else
  return lanes_from_unsigned(vld1q_u32(from));
#endif
}
LANES_INLINE lanes lanes_load_kinds(const uint8_t *from) {
  uint32_t four;
  bytes_copy(&four, from, sizeof four);
  return lanes_from_unsigned(vmovl_u16(vget_low_u16(vmovl_u8(vcreate_u8(four)))));
}

/* There are no masked loads and stores: lane by lane. */
#define LANES_EACH(X) X(0) X(1) X(2) X(3)

LANES_INLINE lanes lanes_load_masked(lanes others, const int32_t *from, lane_mask m) {
  const uint32_t used = mask_bits(m);
  lanes v = others;
#define X(n) if ((used >> n & 1u) != 0) v = vld1q_lane_s32(from + n, v, n);
  LANES_EACH(X)
#undef X
  return v;
}
LANES_INLINE void lanes_store_masked(int32_t *to, lane_mask m, lanes v) {
  const uint32_t used = mask_bits(m);
#define X(n) if ((used >> n & 1u) != 0) vst1q_lane_s32(to + n, v, n);
  LANES_EACH(X)
#undef X
}
LANES_INLINE lanes lanes_load_ids_first(const index_t *from, uint32_t count) {
  index_t ids[LANES] = {0, 0, 0, 0};
  for (uint32_t n = 0; n < count; ++n) ids[n] = from[n];
  return lanes_load_ids(ids);
}
LANES_INLINE lanes lanes_load_kinds_first(const uint8_t *from, uint32_t count) {
  uint8_t kinds[LANES] = {0, 0, 0, 0};
  for (uint32_t n = 0; n < count; ++n) kinds[n] = from[n];
  return lanes_load_kinds(kinds);
}

#endif
