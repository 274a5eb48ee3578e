/* SPDX-License-Identifier: Apache-2.0 */
/* Eight 32-bit lanes on x86-64 with AVX2. */
#ifndef FRAY_SIMD_LANES_AVX2_H
#define FRAY_SIMD_LANES_AVX2_H

#include <immintrin.h>

#include "rt/state/spring.h"

enum { LANES = 8, LANES_ALL = 255 };
#define LANES_RUNS_UNROLLED 4
#define LANES_GROUPS 8 /* groups of springs side by side */
typedef __m256i lanes;
typedef __m256i lane_mask; /* all ones or all zeros a lane */

#define LANES_INLINE static inline __attribute__((always_inline))

LANES_INLINE lanes lanes_set(int32_t v) { return _mm256_set1_epi32(v); }
LANES_INLINE lanes lanes_set_from(const int32_t *v) { return _mm256_set1_epi32(*v); }
LANES_INLINE lanes lanes_add(lanes a, lanes b) { return _mm256_add_epi32(a, b); }
LANES_INLINE lanes lanes_sub(lanes a, lanes b) { return _mm256_sub_epi32(a, b); }
LANES_INLINE lanes lanes_mul(lanes a, lanes b) { return _mm256_mullo_epi32(a, b); }
LANES_INLINE lanes lanes_min(lanes a, lanes b) { return _mm256_min_epi32(a, b); }
LANES_INLINE lanes lanes_max(lanes a, lanes b) { return _mm256_max_epi32(a, b); }
LANES_INLINE lanes lanes_asr(lanes v, unsigned s) { return _mm256_sra_epi32(v, _mm_cvtsi32_si128((int)s)); }
LANES_INLINE lanes lanes_shl(lanes v, unsigned s) { return _mm256_sll_epi32(v, _mm_cvtsi32_si128((int)s)); }
LANES_INLINE lanes lanes_asr_by(lanes v, lanes s) { return _mm256_srav_epi32(v, s); }
LANES_INLINE lanes lanes_shl_by(lanes v, lanes s) { return _mm256_sllv_epi32(v, s); }
LANES_INLINE lane_mask lanes_greater(lanes a, lanes b) { return _mm256_cmpgt_epi32(a, b); }
LANES_INLINE lanes lanes_sign(lanes v) { return _mm256_srai_epi32(v, 31); }
LANES_INLINE lane_mask lanes_negative(lanes v) { return _mm256_srai_epi32(v, 31); }
LANES_INLINE lanes lanes_select(lane_mask m, lanes yes, lanes no) {
  return _mm256_blendv_epi8(no, yes, m);
}
LANES_INLINE lanes lanes_or_zero(lane_mask m, lanes v) { return _mm256_and_si256(m, v); }

LANES_INLINE lane_mask mask_first(uint32_t count) {
  const __m256i n = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  return _mm256_cmpgt_epi32(_mm256_set1_epi32((int32_t)count), n);
}
LANES_INLINE lanes lanes_gather(const int32_t *from, const uint32_t at[LANES]) {
  return _mm256_set_epi32(from[at[7]], from[at[6]], from[at[5]], from[at[4]], from[at[3]],
                          from[at[2]], from[at[1]], from[at[0]]);
}
/* Words of a table by the low bits of `at`, all of which must be in it: 8 words. */
#define LANES_TABLE_WORDS 8
LANES_INLINE lanes lanes_lookup(const int32_t *table, lanes at) {
  return _mm256_permutevar8x32_epi32(_mm256_loadu_si256((const __m256i *)(const void *)table), at);
}
LANES_INLINE lanes lanes_load(const int32_t *from) {
  return _mm256_loadu_si256((const __m256i *)(const void *)from);
}
LANES_INLINE void lanes_store(int32_t *to, lanes v) {
  _mm256_storeu_si256((__m256i *)(void *)to, v);
}
LANES_INLINE lanes lanes_load_masked(lanes others, const int32_t *from, lane_mask m) {
  return _mm256_or_si256(_mm256_andnot_si256(m, others), _mm256_maskload_epi32(from, m));
}
LANES_INLINE void lanes_store_masked(int32_t *to, lane_mask m, lanes v) {
  _mm256_maskstore_epi32(to, m, v);
}

/* Lanes `first` to `first + count - 1`, fewer than all, in parts of 4, 2 and 1: masked stores are 40
 * operations on some processors. */
#define LANES_HAVE_STORE_RUN
LANES_INLINE void lanes_store_run(int32_t *to, uint32_t first, uint32_t count, lanes v) {
  const __m256i n = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const __m256i from = _mm256_add_epi32(n, _mm256_set1_epi32((int32_t)first));
  const __m256i moved = _mm256_permutevar8x32_epi32(v, from);
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

/* Ids and kinds of consecutive springs. */
LANES_INLINE lanes lanes_load_ids(const index_t *from) {
#if FRAY_ID_BITS == 16
  return _mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)(const void *)from));
#else
  return _mm256_loadu_si256((const __m256i *)(const void *)from);
#endif
}
/* Whether the ids are first, first + 1, ... */
LANES_INLINE int lanes_are_consecutive(lanes ids, index_t first) {
  const __m256i n = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7);
  const __m256i run = _mm256_add_epi32(n, _mm256_set1_epi32((int32_t)first));
  const __m256i other = _mm256_xor_si256(ids, run);
  return _mm256_testz_si256(other, other);
}
/* Whether the ids of LANES springs are consecutive and all have this kind. */
LANES_INLINE int lanes_are_run(const index_t *i, const index_t *j, const uint8_t *kinds, uint32_t kind) {
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
/* Bit n: id n is not id n - 1 plus 1, for n > 0. */
LANES_INLINE uint32_t lanes_run_starts(lanes ids) {
  const __m256i before = _mm256_permutevar8x32_epi32(ids, _mm256_setr_epi32(0, 0, 1, 2, 3, 4, 5, 6));
  const __m256i next = _mm256_add_epi32(before, _mm256_set1_epi32(1));
  return ~(uint32_t)_mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(ids, next))) & 254u;
}
/* Of the lanes in `bits`, those from `first` to `end` - 1. */
LANES_INLINE lane_mask mask_range(uint32_t bits, uint32_t first, uint32_t end) {
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
LANES_INLINE lane_mask lanes_not_equal(lanes a, lanes b) {
  return _mm256_xor_si256(_mm256_cmpeq_epi32(a, b), _mm256_set1_epi32(-1));
}
LANES_INLINE uint32_t mask_bits(lane_mask m) {
  return (uint32_t)_mm256_movemask_ps(_mm256_castsi256_ps(m));
}
LANES_INLINE lanes lanes_load_ids_first(const index_t *from, uint32_t count) {
#if FRAY_ID_BITS == 16
  uint16_t ids[LANES] = {0, 0, 0, 0, 0, 0, 0, 0};
  for (uint32_t n = 0; n < count; ++n) ids[n] = from[n];
  return lanes_load_ids(ids);
#else
  return _mm256_maskload_epi32((const int *)from, mask_first(count));
#endif
}
LANES_INLINE lanes lanes_load_kinds_first(const uint8_t *from, uint32_t count) {
  uint64_t kinds = 0;
  for (uint32_t n = 0; n < count; ++n) kinds |= (uint64_t)from[n] << 8 * n;
  return _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((int64_t)kinds));
}
LANES_INLINE lane_mask mask_and(lane_mask a, lane_mask b) { return _mm256_and_si256(a, b); }
LANES_INLINE lane_mask mask_or(lane_mask a, lane_mask b) { return _mm256_or_si256(a, b); }
LANES_INLINE lane_mask mask_and_not(lane_mask a, lane_mask b) { return _mm256_andnot_si256(b, a); }
/* Unsigned. */
LANES_INLINE lanes lanes_min_unsigned(lanes a, lanes b) { return _mm256_min_epu32(a, b); }

/* 64-bit lanes: of the even 32-bit lanes, and of the odd ones. */
#define LANES_HAVE_64
typedef struct {
  __m256i even, odd;
} lanes64;
LANES_INLINE __m256i lanes_odd(lanes v) { return _mm256_srli_epi64(v, 32); }
LANES_INLINE lanes64 lanes64_set(int64_t v) {
  return (lanes64){_mm256_set1_epi64x(v), _mm256_set1_epi64x(v)};
}
LANES_INLINE lanes64 lanes64_add(lanes64 a, lanes64 b) {
  return (lanes64){_mm256_add_epi64(a.even, b.even), _mm256_add_epi64(a.odd, b.odd)};
}
LANES_INLINE lanes64 lanes64_sub(lanes64 a, lanes64 b) {
  return (lanes64){_mm256_sub_epi64(a.even, b.even), _mm256_sub_epi64(a.odd, b.odd)};
}
/* Unsigned shifts. */
LANES_INLINE lanes64 lanes64_shr(lanes64 v, unsigned s) {
  return (lanes64){_mm256_srli_epi64(v.even, (int)s), _mm256_srli_epi64(v.odd, (int)s)};
}
LANES_INLINE lanes64 lanes64_shl(lanes64 v, unsigned s) {
  return (lanes64){_mm256_slli_epi64(v.even, (int)s), _mm256_slli_epi64(v.odd, (int)s)};
}
LANES_INLINE __m256i lanes_even(lanes v) { return _mm256_blend_epi32(v, _mm256_setzero_si256(), 0xAA); }
/* All ones where v is negative. */
LANES_INLINE lanes64 lanes64_sign(lanes64 v) {
  const __m256i zero = _mm256_setzero_si256();
  return (lanes64){_mm256_cmpgt_epi64(zero, v.even), _mm256_cmpgt_epi64(zero, v.odd)};
}
LANES_INLINE lanes lanes64_low(lanes64 v) {
  return _mm256_blend_epi32(v.even, _mm256_slli_epi64(v.odd, 32), 0xAA);
}
LANES_INLINE lanes lanes64_high(lanes64 v) {
  return _mm256_blend_epi32(_mm256_srli_epi64(v.even, 32), v.odd, 0xAA);
}
LANES_INLINE lanes64 lanes64_or(lanes64 a, lanes64 b) {
  return (lanes64){_mm256_or_si256(a.even, b.even), _mm256_or_si256(a.odd, b.odd)};
}
LANES_INLINE lanes64 lanes64_xor(lanes64 a, lanes64 b) {
  return (lanes64){_mm256_xor_si256(a.even, b.even), _mm256_xor_si256(a.odd, b.odd)};
}
/* Zero-extended. */
LANES_INLINE lanes64 lanes64_from(lanes v) { return (lanes64){lanes_even(v), lanes_odd(v)}; }
LANES_INLINE lanes lanes_and(lanes a, lanes b) { return _mm256_and_si256(a, b); }

/* Of low words, where what is above them may be anything. */
LANES_INLINE lanes64 lanes64_words(lanes v) { return (lanes64){v, lanes_odd(v)}; }
LANES_INLINE lanes64 lanes64_mul_low(lanes64 a, lanes64 b) {
  return (lanes64){_mm256_mul_epi32(a.even, b.even), _mm256_mul_epi32(a.odd, b.odd)};
}
LANES_INLINE lanes64 lanes64_mul_low_u(lanes64 a, lanes64 b) {
  return (lanes64){_mm256_mul_epu32(a.even, b.even), _mm256_mul_epu32(a.odd, b.odd)};
}
/* Word by word, high ones too. */
LANES_INLINE lanes64 lanes64_add_words(lanes64 a, lanes64 b) {
  return (lanes64){_mm256_add_epi32(a.even, b.even), _mm256_add_epi32(a.odd, b.odd)};
}
LANES_INLINE lanes64 lanes64_asr_words(lanes64 v, unsigned s) {
  return (lanes64){_mm256_srai_epi32(v.even, (int)s), _mm256_srai_epi32(v.odd, (int)s)};
}
LANES_INLINE lanes64 lanes64_min_words_u(lanes64 a, lanes64 b) {
  return (lanes64){_mm256_min_epu32(a.even, b.even), _mm256_min_epu32(a.odd, b.odd)};
}
LANES_INLINE lanes64 lanes64_shr_by64(lanes64 v, lanes64 s) {
  return (lanes64){_mm256_srlv_epi64(v.even, s.even), _mm256_srlv_epi64(v.odd, s.odd)};
}
LANES_INLINE lanes64 lanes64_shl_by64(lanes64 v, lanes64 s) {
  return (lanes64){_mm256_sllv_epi64(v.even, s.even), _mm256_sllv_epi64(v.odd, s.odd)};
}
LANES_INLINE __m256i lanes_select_negative64(__m256i which, __m256i yes, __m256i no) {
  return _mm256_castpd_si256(_mm256_blendv_pd(_mm256_castsi256_pd(no), _mm256_castsi256_pd(yes),
                                              _mm256_castsi256_pd(which)));
}
/* `yes` where `which` is negative. */
LANES_INLINE lanes64 lanes64_select_negative(lanes64 which, lanes64 yes, lanes64 no) {
  return (lanes64){lanes_select_negative64(which.even, yes.even, no.even),
                   lanes_select_negative64(which.odd, yes.odd, no.odd)};
}

LANES_INLINE __m128i lanes_record(const int32_t *record) {
  return _mm_loadu_si128((const __m128i *)(const void *)record);
}
/* Four words of each of the records at[0], at[4], `words` apart, side by side. */
LANES_INLINE lanes lanes_load_records(const int32_t *from, uint32_t words, const uint32_t *at) {
  const __m256i one = _mm256_castsi128_si256(lanes_record(from + (size_t)words * at[0]));
  return _mm256_inserti128_si256(one, lanes_record(from + (size_t)words * at[4]), 1);
}
/* In every four lanes: a0 b0 a1 b1, or a2 b2 a3 b3. */
LANES_INLINE lanes lanes_unpack_low(lanes a, lanes b) { return _mm256_unpacklo_epi32(a, b); }
LANES_INLINE lanes lanes_unpack_high(lanes a, lanes b) { return _mm256_unpackhi_epi32(a, b); }
/* In every four lanes: a0 a1 b0 b1, or a2 a3 b2 b3. */
LANES_INLINE lanes lanes_unpack64_low(lanes a, lanes b) { return _mm256_unpacklo_epi64(a, b); }
LANES_INLINE lanes lanes_unpack64_high(lanes a, lanes b) { return _mm256_unpackhi_epi64(a, b); }

#endif
