/* SPDX-License-Identifier: Apache-2.0 */
/* Eight 32-bit lanes on x86-64 with AVX2. */
#ifndef FRAY_WIDE_LANES_AVX2_H
#define FRAY_WIDE_LANES_AVX2_H

#include <immintrin.h>

#include "rt/model/rows.h"

enum { LANES = 8, LANES_ALL = 255 };
#define LANES_RUNS 4 /* at most so many runs are stitched */
#define LANES_MANY 8 /* groups taken side by side: see pairs.h */
typedef __m256i lanes;
typedef __m256i lane_mask; /* all ones or all zeros a lane */

#define LANES_INLINE static inline __attribute__((always_inline))

LANES_INLINE lanes lanes_all(int32_t v) { return _mm256_set1_epi32(v); }
LANES_INLINE lanes lanes_word(const int32_t *v) { return _mm256_set1_epi32(*v); }
LANES_INLINE lanes lanes_add(lanes a, lanes b) { return _mm256_add_epi32(a, b); }
LANES_INLINE lanes lanes_sub(lanes a, lanes b) { return _mm256_sub_epi32(a, b); }
LANES_INLINE lanes lanes_mul(lanes a, lanes b) { return _mm256_mullo_epi32(a, b); }
LANES_INLINE lanes lanes_min(lanes a, lanes b) { return _mm256_min_epi32(a, b); }
LANES_INLINE lanes lanes_max(lanes a, lanes b) { return _mm256_max_epi32(a, b); }
LANES_INLINE lanes lanes_asr(lanes v, unsigned s) { return _mm256_sra_epi32(v, _mm_cvtsi32_si128((int)s)); }
LANES_INLINE lanes lanes_shl(lanes v, unsigned s) { return _mm256_sll_epi32(v, _mm_cvtsi32_si128((int)s)); }
LANES_INLINE lanes lanes_asr_by(lanes v, lanes s) { return _mm256_srav_epi32(v, s); }
LANES_INLINE lanes lanes_shl_by(lanes v, lanes s) { return _mm256_sllv_epi32(v, s); }
LANES_INLINE lane_mask lanes_above(lanes a, lanes b) { return _mm256_cmpgt_epi32(a, b); }
LANES_INLINE lanes lanes_sign(lanes v) { return _mm256_srai_epi32(v, 31); }
LANES_INLINE lane_mask lanes_below_zero(lanes v) { return _mm256_srai_epi32(v, 31); }
LANES_INLINE lanes lanes_pick(lane_mask m, lanes yes, lanes no) {
  return _mm256_blendv_epi8(no, yes, m);
}
LANES_INLINE lanes lanes_keep(lane_mask m, lanes v) { return _mm256_and_si256(m, v); }

LANES_INLINE lane_mask lanes_first(uint32_t count) {
  const __m256i n = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  return _mm256_cmpgt_epi32(_mm256_set1_epi32((int32_t)count), n);
}
LANES_INLINE lanes lanes_of(const int32_t *from, const uint32_t at[LANES]) {
  return _mm256_set_epi32(from[at[7]], from[at[6]], from[at[5]], from[at[4]], from[at[3]],
                          from[at[2]], from[at[1]], from[at[0]]);
}
/* Words of a table by the low bits of `at`, all of which must be in it: 8 words. */
#define LANES_TABLE 8
LANES_INLINE lanes lanes_from(const int32_t *table, lanes at) {
  return _mm256_permutevar8x32_epi32(_mm256_loadu_si256((const __m256i *)(const void *)table), at);
}
LANES_INLINE lanes lanes_load(const int32_t *from) {
  return _mm256_loadu_si256((const __m256i *)(const void *)from);
}
LANES_INLINE void lanes_store(int32_t *to, lanes v) {
  _mm256_storeu_si256((__m256i *)(void *)to, v);
}
LANES_INLINE lanes lanes_load_part(lanes others, const int32_t *from, lane_mask m) {
  return _mm256_or_si256(_mm256_andnot_si256(m, others), _mm256_maskload_epi32(from, m));
}
LANES_INLINE void lanes_store_part(int32_t *to, lane_mask m, lanes v) {
  _mm256_maskstore_epi32(to, m, v);
}

/* Lanes `first` to `first + count - 1`, fewer than all, in as few parts as there are: to store by a mask takes
 * some processors longer than all else that is done to these lanes. */
#define LANES_STORE_RUN
LANES_INLINE void lanes_store_run(int32_t *to, uint32_t first, uint32_t count, lanes v) {
  const __m256i n = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const __m256i moved = _mm256_permutevar8x32_epi32(v, _mm256_add_epi32(n, _mm256_set1_epi32((int32_t)first)));
  __m128i left = _mm256_castsi256_si128(moved);
  if ((count & 4u) != 0) {
    _mm_storeu_si128((__m128i *)(void *)to, left);
    left = _mm256_extracti128_si256(moved, 1);
    to += 4;
  }
  if ((count & 2u) != 0) {
    _mm_storel_epi64((__m128i *)(void *)to, left);
    left = _mm_unpackhi_epi64(left, left);
    to += 2;
  }
  if ((count & 1u) != 0) *to = _mm_cvtsi128_si32(left);
}

/* Rows of a batch: their ids as lanes, kinds as bits. */
LANES_INLINE lanes lanes_load_ids(const row_id *from) {
#if FRAY_ID_BITS == 16
  return _mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)(const void *)from));
#else
  return _mm256_loadu_si256((const __m256i *)(const void *)from);
#endif
}
/* Whether the ids are first, first + 1, ... */
LANES_INLINE int lanes_count_up(lanes ids, row_id first) {
  const __m256i n = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const __m256i run = _mm256_add_epi32(n, _mm256_set1_epi32((int32_t)first));
  const __m256i other = _mm256_xor_si256(ids, run);
  return _mm256_testz_si256(other, other);
}
/* Whether the ids of LANES rows count up and all are of that kind. */
LANES_INLINE int lanes_are_run(const row_id *i, const row_id *j, const uint8_t *kinds, uint32_t kind) {
  const __m256i n = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const __m256i a = lanes_load_ids(i);
  const __m256i b = lanes_load_ids(j);
  const __m256i run_a = _mm256_add_epi32(_mm256_broadcastd_epi32(_mm256_castsi256_si128(a)), n);
  const __m256i run_b = _mm256_add_epi32(_mm256_broadcastd_epi32(_mm256_castsi256_si128(b)), n);
  const __m256i other = _mm256_or_si256(_mm256_xor_si256(a, run_a), _mm256_xor_si256(b, run_b));
  uint64_t eight;
  __builtin_memcpy(&eight, kinds, sizeof eight);
  return _mm256_testz_si256(other, other) && eight == kind * 0x0101010101010101u;
}
/* Bit n: id n does not follow id n - 1. */
LANES_INLINE uint32_t lanes_breaks(lanes ids) {
  const __m256i before = _mm256_permutevar8x32_epi32(ids, _mm256_setr_epi32(0, 0, 1, 2, 3, 4, 5, 6));
  const __m256i next = _mm256_add_epi32(before, _mm256_set1_epi32(1));
  return ~(uint32_t)_mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(ids, next))) & 254u;
}
/* Of the lanes in `bits`, those from `first` to `end` - 1. */
LANES_INLINE lane_mask lanes_between(uint32_t bits, uint32_t first, uint32_t end) {
  const uint32_t m = bits & ((1u << end) - (1u << first));
  const __m256i lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
  return _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int32_t)m), lane), lane);
}
LANES_INLINE lanes lanes_load_kinds(const uint8_t *from) {
  return _mm256_cvtepu8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)from));
}
LANES_INLINE int lanes_all_equal(lanes v, uint32_t to) {
  const __m256i other = _mm256_xor_si256(v, _mm256_set1_epi32((int32_t)to));
  return _mm256_testz_si256(other, other);
}
LANES_INLINE lane_mask lanes_differ(lanes a, lanes b) {
  return _mm256_xor_si256(_mm256_cmpeq_epi32(a, b), _mm256_set1_epi32(-1));
}
LANES_INLINE uint32_t lanes_bits(lane_mask m) {
  return (uint32_t)_mm256_movemask_ps(_mm256_castsi256_ps(m));
}
LANES_INLINE lanes lanes_load_ids_part(const row_id *from, uint32_t count) {
#if FRAY_ID_BITS == 16
  uint16_t ids[LANES] = {0, 0, 0, 0, 0, 0, 0, 0};
  for (uint32_t n = 0; n < count; ++n) ids[n] = from[n];
  return lanes_load_ids(ids);
#else
  return _mm256_maskload_epi32((const int *)from, lanes_first(count));
#endif
}
LANES_INLINE lanes lanes_load_kinds_part(const uint8_t *from, uint32_t count) {
  uint64_t kinds = 0;
  for (uint32_t n = 0; n < count; ++n) kinds |= (uint64_t)from[n] << 8 * n;
  return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((int64_t)kinds));
}
LANES_INLINE lane_mask lanes_both(lane_mask a, lane_mask b) { return _mm256_and_si256(a, b); }
LANES_INLINE lane_mask lanes_either(lane_mask a, lane_mask b) { return _mm256_or_si256(a, b); }
LANES_INLINE lane_mask lanes_without(lane_mask a, lane_mask b) { return _mm256_andnot_si256(b, a); }
/* Of naturals. */
LANES_INLINE lanes lanes_lesser(lanes a, lanes b) { return _mm256_min_epu32(a, b); }

/* 64-bit lanes: those of the even lanes and those of the odd ones. */
#define LANES_LONGS
typedef struct {
  __m256i even, odd;
} longs;
LANES_INLINE __m256i lanes_odd(lanes v) { return _mm256_srli_epi64(v, 32); }
LANES_INLINE longs longs_all(int64_t v) { return (longs){_mm256_set1_epi64x(v), _mm256_set1_epi64x(v)}; }
LANES_INLINE longs longs_mul(lanes a, lanes b) {
  return (longs){_mm256_mul_epi32(a, b), _mm256_mul_epi32(lanes_odd(a), lanes_odd(b))};
}
LANES_INLINE longs longs_mul_u(lanes a, lanes b) {
  return (longs){_mm256_mul_epu32(a, b), _mm256_mul_epu32(lanes_odd(a), lanes_odd(b))};
}
LANES_INLINE longs longs_add(longs a, longs b) {
  return (longs){_mm256_add_epi64(a.even, b.even), _mm256_add_epi64(a.odd, b.odd)};
}
LANES_INLINE longs longs_sub(longs a, longs b) {
  return (longs){_mm256_sub_epi64(a.even, b.even), _mm256_sub_epi64(a.odd, b.odd)};
}
/* Shifts are those of naturals. */
LANES_INLINE longs longs_shr(longs v, unsigned s) {
  return (longs){_mm256_srli_epi64(v.even, (int)s), _mm256_srli_epi64(v.odd, (int)s)};
}
LANES_INLINE longs longs_shl(longs v, unsigned s) {
  return (longs){_mm256_slli_epi64(v.even, (int)s), _mm256_slli_epi64(v.odd, (int)s)};
}
LANES_INLINE __m256i lanes_even(lanes v) { return _mm256_blend_epi32(v, _mm256_setzero_si256(), 0xAA); }
LANES_INLINE longs longs_shr_by(longs v, lanes s) {
  return (longs){_mm256_srlv_epi64(v.even, lanes_even(s)), _mm256_srlv_epi64(v.odd, lanes_odd(s))};
}
LANES_INLINE longs longs_shl_by(longs v, lanes s) {
  return (longs){_mm256_sllv_epi64(v.even, lanes_even(s)), _mm256_sllv_epi64(v.odd, lanes_odd(s))};
}
/* All ones below zero. */
LANES_INLINE longs longs_sign(longs v) {
  const __m256i zero = _mm256_setzero_si256();
  return (longs){_mm256_cmpgt_epi64(zero, v.even), _mm256_cmpgt_epi64(zero, v.odd)};
}
LANES_INLINE lanes longs_low(longs v) {
  return _mm256_blend_epi32(v.even, _mm256_slli_epi64(v.odd, 32), 0xAA);
}
LANES_INLINE lanes longs_high(longs v) {
  return _mm256_blend_epi32(_mm256_srli_epi64(v.even, 32), v.odd, 0xAA);
}
LANES_INLINE longs longs_or(longs a, longs b) {
  return (longs){_mm256_or_si256(a.even, b.even), _mm256_or_si256(a.odd, b.odd)};
}
LANES_INLINE longs longs_xor(longs a, longs b) {
  return (longs){_mm256_xor_si256(a.even, b.even), _mm256_xor_si256(a.odd, b.odd)};
}
/* Of lanes that are not below zero. */
LANES_INLINE longs longs_of(lanes v) { return (longs){lanes_even(v), lanes_odd(v)}; }
LANES_INLINE lanes lanes_and(lanes a, lanes b) { return _mm256_and_si256(a, b); }

LANES_INLINE __m128i lanes_record(const int32_t *record) {
  return _mm_loadu_si128((const __m128i *)(const void *)record);
}
/* Four words of each of the records at[0], at[4], of so many words each, beside one another. */
LANES_INLINE lanes lanes_four(const int32_t *from, uint32_t words, const uint32_t *at) {
  const __m256i one = _mm256_castsi128_si256(lanes_record(from + words * at[0]));
  return _mm256_inserti128_si256(one, lanes_record(from + words * at[4]), 1);
}
/* In every four lanes: a0 b0 a1 b1, or a2 b2 a3 b3. */
LANES_INLINE lanes lanes_mix_low(lanes a, lanes b) { return _mm256_unpacklo_epi32(a, b); }
LANES_INLINE lanes lanes_mix_high(lanes a, lanes b) { return _mm256_unpackhi_epi32(a, b); }
/* In every four lanes: a0 a1 b0 b1, or a2 a3 b2 b3. */
LANES_INLINE lanes lanes_twos_low(lanes a, lanes b) { return _mm256_unpacklo_epi64(a, b); }
LANES_INLINE lanes lanes_twos_high(lanes a, lanes b) { return _mm256_unpackhi_epi64(a, b); }

#endif
