/* SPDX-License-Identifier: Apache-2.0 */
/* Sixteen 32-bit lanes on x86-64 with AVX-512 (F, BW, DQ, VL). */
#ifndef FRAY_SIMD_LANES_AVX512_H
#define FRAY_SIMD_LANES_AVX512_H

#include <immintrin.h>

#include "rt/state/spring.h"

enum { LANES = 16, LANES_ALL = 65535 };
#define LANES_RUNS_UNROLLED 4
#define LANES_RUNS_MAX 6
#define LANES_GROUPS 2 /* groups of springs side by side */
typedef __m512i lanes;
typedef __mmask16 lane_mask;

#define LANES_INLINE static inline __attribute__((always_inline))

LANES_INLINE lanes lanes_set(int32_t v) { return _mm512_set1_epi32(v); }
LANES_INLINE lanes lanes_set_from(const int32_t *v) { return _mm512_set1_epi32(*v); }
LANES_INLINE lanes lanes_add(lanes a, lanes b) { return _mm512_add_epi32(a, b); }
LANES_INLINE lanes lanes_sub(lanes a, lanes b) { return _mm512_sub_epi32(a, b); }
LANES_INLINE lanes lanes_mul(lanes a, lanes b) { return _mm512_mullo_epi32(a, b); }
LANES_INLINE lanes lanes_min(lanes a, lanes b) { return _mm512_min_epi32(a, b); }
LANES_INLINE lanes lanes_max(lanes a, lanes b) { return _mm512_max_epi32(a, b); }
LANES_INLINE lanes lanes_asr(lanes v, unsigned s) { return _mm512_sra_epi32(v, _mm_cvtsi32_si128((int)s)); }
LANES_INLINE lanes lanes_shl(lanes v, unsigned s) { return _mm512_sll_epi32(v, _mm_cvtsi32_si128((int)s)); }
LANES_INLINE lanes lanes_asr_by(lanes v, lanes s) { return _mm512_srav_epi32(v, s); }
LANES_INLINE lanes lanes_shl_by(lanes v, lanes s) { return _mm512_sllv_epi32(v, s); }
LANES_INLINE lane_mask lanes_greater(lanes a, lanes b) { return _mm512_cmpgt_epi32_mask(a, b); }
LANES_INLINE lanes lanes_sign(lanes v) { return _mm512_srai_epi32(v, 31); }
LANES_INLINE lane_mask lanes_negative(lanes v) { return _mm512_movepi32_mask(v); }
LANES_INLINE lanes lanes_select(lane_mask m, lanes yes, lanes no) {
  return _mm512_mask_blend_epi32(m, no, yes);
}
LANES_INLINE lanes lanes_or_zero(lane_mask m, lanes v) { return _mm512_maskz_mov_epi32(m, v); }

LANES_INLINE lane_mask mask_first(uint32_t count) {
  return (lane_mask)((1u << count) - 1u);
}
LANES_INLINE lanes lanes_gather(const int32_t *from, const uint32_t at[LANES]) {
  return _mm512_set_epi32(from[at[15]], from[at[14]], from[at[13]], from[at[12]], from[at[11]],
                          from[at[10]], from[at[9]], from[at[8]], from[at[7]], from[at[6]],
                          from[at[5]], from[at[4]], from[at[3]], from[at[2]], from[at[1]],
                          from[at[0]]);
}
/* Words of a table by the low bits of `at`, all of which must be in it: 32 words. */
#define LANES_TABLE_WORDS 32
LANES_INLINE lanes lanes_lookup(const int32_t *table, lanes at) {
  return _mm512_permutex2var_epi32(_mm512_loadu_si512(table), at, _mm512_loadu_si512(table + 16));
}
LANES_INLINE lanes lanes_load(const int32_t *from) { return _mm512_loadu_si512(from); }
LANES_INLINE void lanes_store(int32_t *to, lanes v) { _mm512_storeu_si512(to, v); }
LANES_INLINE lanes lanes_load_masked(lanes others, const int32_t *from, lane_mask m) {
  return _mm512_mask_loadu_epi32(others, m, from);
}
LANES_INLINE void lanes_store_masked(int32_t *to, lane_mask m, lanes v) {
  _mm512_mask_storeu_epi32(to, m, v);
}
/* Two runs, each half of the lanes. */
#define LANES_HAVE_HALVES
LANES_INLINE lanes lanes_load_halves(const int32_t *low, const int32_t *high) {
  return _mm512_inserti64x4(_mm512_castsi256_si512(_mm256_loadu_si256((const __m256i *)(const void *)low)),
                            _mm256_loadu_si256((const __m256i *)(const void *)high), 1);
}
LANES_INLINE void lanes_store_halves(int32_t *low, int32_t *high, lanes v) {
  _mm256_storeu_si256((__m256i *)(void *)low, _mm512_castsi512_si256(v));
  _mm256_storeu_si256((__m256i *)(void *)high, _mm512_extracti64x4_epi64(v, 1));
}
LANES_INLINE lanes lanes_load_ids(const index_t *from) {
#if FRAY_ID_BITS == 16
  return _mm512_cvtepu16_epi32(_mm256_loadu_si256((const __m256i *)(const void *)from));
#else
  return _mm512_loadu_si512(from);
#endif
}
/* Whether the ids are first, first + 1, ... */
LANES_INLINE int lanes_are_consecutive(lanes ids, index_t first) {
  const __m512i n = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  return _mm512_cmpneq_epi32_mask(
             ids, _mm512_add_epi32(n, _mm512_set1_epi32((int32_t)first))) == 0;
}
/* Whether the ids of LANES springs are consecutive and all have this kind. */
LANES_INLINE int lanes_are_run(const index_t *i, const index_t *j, const uint8_t *kinds, uint32_t kind) {
  const __m128i k = _mm_loadu_si128((const __m128i *)(const void *)kinds);
  return lanes_are_consecutive(lanes_load_ids(i), *i) && lanes_are_consecutive(lanes_load_ids(j), *j) &&
         _mm_cmpneq_epu8_mask(k, _mm_set1_epi8((char)kind)) == 0;
}
/* Bit n: id n is not id n - 1 plus 1, for n > 0. */
LANES_INLINE uint32_t lanes_run_starts(lanes ids) {
  const __m512i before = _mm512_alignr_epi32(ids, ids, 15);
  const __m512i next = _mm512_add_epi32(before, _mm512_set1_epi32(1));
  return _mm512_cmpneq_epi32_mask(ids, next) & ~1u;
}
/* Of the lanes in `bits`, those from `first` to `end` - 1. */
LANES_INLINE lane_mask mask_range(uint32_t bits, uint32_t first, uint32_t end) {
  return (lane_mask)(bits & ((1u << end) - (1u << first)));
}
LANES_INLINE lanes lanes_load_kinds(const uint8_t *from) {
  return _mm512_cvtepu8_epi32(_mm_loadu_si128((const __m128i *)(const void *)from));
}
LANES_INLINE int lanes_all_equal(lanes v, uint32_t to) {
  return _mm512_cmpneq_epi32_mask(v, _mm512_set1_epi32((int32_t)to)) == 0;
}
LANES_INLINE lane_mask lanes_not_equal(lanes a, lanes b) { return _mm512_cmpneq_epi32_mask(a, b); }
LANES_INLINE uint32_t mask_bits(lane_mask m) { return m; }
LANES_INLINE lanes lanes_load_ids_first(const index_t *from, uint32_t count) {
#if FRAY_ID_BITS == 16
  return _mm512_cvtepu16_epi32(_mm256_maskz_loadu_epi16(mask_first(count), from));
#else
  return _mm512_maskz_loadu_epi32(mask_first(count), from);
#endif
}
LANES_INLINE lanes lanes_load_kinds_first(const uint8_t *from, uint32_t count) {
  return _mm512_cvtepu8_epi32(_mm_maskz_loadu_epi8(mask_first(count), from));
}
LANES_INLINE lane_mask mask_and(lane_mask a, lane_mask b) { return (lane_mask)(a & b); }
LANES_INLINE lane_mask mask_or(lane_mask a, lane_mask b) { return (lane_mask)(a | b); }
LANES_INLINE lane_mask mask_and_not(lane_mask a, lane_mask b) { return (lane_mask)(a & ~b); }
/* Unsigned. */
LANES_INLINE lanes lanes_min_unsigned(lanes a, lanes b) { return _mm512_min_epu32(a, b); }

/* 64-bit lanes: of the even 32-bit lanes, and of the odd ones. */
#define LANES_HAVE_64
typedef struct {
  __m512i even, odd;
} lanes64;
LANES_INLINE __m512i lanes_odd(lanes v) { return _mm512_srli_epi64(v, 32); }
LANES_INLINE lanes64 lanes64_set(int64_t v) { return (lanes64){_mm512_set1_epi64(v), _mm512_set1_epi64(v)}; }
LANES_INLINE lanes64 lanes64_add(lanes64 a, lanes64 b) {
  return (lanes64){_mm512_add_epi64(a.even, b.even), _mm512_add_epi64(a.odd, b.odd)};
}
LANES_INLINE lanes64 lanes64_sub(lanes64 a, lanes64 b) {
  return (lanes64){_mm512_sub_epi64(a.even, b.even), _mm512_sub_epi64(a.odd, b.odd)};
}
/* Unsigned shifts. */
LANES_INLINE lanes64 lanes64_shr(lanes64 v, unsigned s) {
  return (lanes64){_mm512_srli_epi64(v.even, s), _mm512_srli_epi64(v.odd, s)};
}
LANES_INLINE lanes64 lanes64_shl(lanes64 v, unsigned s) {
  return (lanes64){_mm512_slli_epi64(v.even, s), _mm512_slli_epi64(v.odd, s)};
}
LANES_INLINE __m512i lanes_even(lanes v) { return _mm512_maskz_mov_epi32(0x5555, v); }
/* All ones where v is negative. */
LANES_INLINE lanes64 lanes64_sign(lanes64 v) {
  return (lanes64){_mm512_srai_epi64(v.even, 63), _mm512_srai_epi64(v.odd, 63)};
}
LANES_INLINE lanes lanes64_low(lanes64 v) {
  return _mm512_mask_blend_epi32(0xAAAA, v.even, _mm512_slli_epi64(v.odd, 32));
}
LANES_INLINE lanes lanes64_high(lanes64 v) {
  return _mm512_mask_blend_epi32(0xAAAA, _mm512_srli_epi64(v.even, 32), v.odd);
}
LANES_INLINE lanes64 lanes64_or(lanes64 a, lanes64 b) {
  return (lanes64){_mm512_or_si512(a.even, b.even), _mm512_or_si512(a.odd, b.odd)};
}
LANES_INLINE lanes64 lanes64_xor(lanes64 a, lanes64 b) {
  return (lanes64){_mm512_xor_si512(a.even, b.even), _mm512_xor_si512(a.odd, b.odd)};
}
/* Zero-extended. */
LANES_INLINE lanes64 lanes64_from(lanes v) { return (lanes64){lanes_even(v), lanes_odd(v)}; }
LANES_INLINE lanes lanes_and(lanes a, lanes b) { return _mm512_and_si512(a, b); }

/* Of low words, where what is above them may be anything. */
LANES_INLINE lanes64 lanes64_words(lanes v) { return (lanes64){v, lanes_odd(v)}; }
LANES_INLINE lanes64 lanes64_mul_low(lanes64 a, lanes64 b) {
  return (lanes64){_mm512_mul_epi32(a.even, b.even), _mm512_mul_epi32(a.odd, b.odd)};
}
LANES_INLINE lanes64 lanes64_mul_low_u(lanes64 a, lanes64 b) {
  return (lanes64){_mm512_mul_epu32(a.even, b.even), _mm512_mul_epu32(a.odd, b.odd)};
}
/* Word by word, high ones too. */
LANES_INLINE lanes64 lanes64_add_words(lanes64 a, lanes64 b) {
  return (lanes64){_mm512_add_epi32(a.even, b.even), _mm512_add_epi32(a.odd, b.odd)};
}
LANES_INLINE lanes64 lanes64_asr_words(lanes64 v, unsigned s) {
  return (lanes64){_mm512_srai_epi32(v.even, s), _mm512_srai_epi32(v.odd, s)};
}
LANES_INLINE lanes64 lanes64_min_words_u(lanes64 a, lanes64 b) {
  return (lanes64){_mm512_min_epu32(a.even, b.even), _mm512_min_epu32(a.odd, b.odd)};
}
LANES_INLINE lanes64 lanes64_shr_by64(lanes64 v, lanes64 s) {
  return (lanes64){_mm512_srlv_epi64(v.even, s.even), _mm512_srlv_epi64(v.odd, s.odd)};
}
LANES_INLINE lanes64 lanes64_shl_by64(lanes64 v, lanes64 s) {
  return (lanes64){_mm512_sllv_epi64(v.even, s.even), _mm512_sllv_epi64(v.odd, s.odd)};
}
/* `yes` where `which` is negative. */
LANES_INLINE lanes64 lanes64_select_negative(lanes64 which, lanes64 yes, lanes64 no) {
  return (lanes64){_mm512_mask_blend_epi64(_mm512_movepi64_mask(which.even), no.even, yes.even),
                   _mm512_mask_blend_epi64(_mm512_movepi64_mask(which.odd), no.odd, yes.odd)};
}

LANES_INLINE __m128i lanes_record(const int32_t *record) {
  return _mm_loadu_si128((const __m128i *)(const void *)record);
}
/* Four words of each of the records at[0], at[4], at[8], at[12], `words` apart, side by side. */
LANES_INLINE lanes lanes_load_records(const int32_t *from, uint32_t words, const uint32_t *at) {
  const __m512i one = _mm512_castsi128_si512(lanes_record(from + (size_t)words * at[0]));
  const __m512i two = _mm512_inserti32x4(one, lanes_record(from + (size_t)words * at[4]), 1);
  const __m512i three = _mm512_inserti32x4(two, lanes_record(from + (size_t)words * at[8]), 2);
  return _mm512_inserti32x4(three, lanes_record(from + (size_t)words * at[12]), 3);
}
/* In every four lanes: a0 b0 a1 b1, or a2 b2 a3 b3. */
LANES_INLINE lanes lanes_unpack_low(lanes a, lanes b) { return _mm512_unpacklo_epi32(a, b); }
LANES_INLINE lanes lanes_unpack_high(lanes a, lanes b) { return _mm512_unpackhi_epi32(a, b); }
/* In every four lanes: a0 a1 b0 b1, or a2 a3 b2 b3. */
LANES_INLINE lanes lanes_unpack64_low(lanes a, lanes b) { return _mm512_unpacklo_epi64(a, b); }
LANES_INLINE lanes lanes_unpack64_high(lanes a, lanes b) { return _mm512_unpackhi_epi64(a, b); }

#endif
