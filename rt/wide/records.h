/* SPDX-License-Identifier: Apache-2.0 */
/* Records of four words, as many as there are lanes: their words in lanes, and back. */
#ifndef FRAY_WIDE_RECORDS_H
#define FRAY_WIDE_RECORDS_H

#include "rt/wide/longs.h"

#ifdef LANES_LONGS
/* Word k of the record at[n], of so many words each, comes to stand in lane n of word[k]. */
LANES_INLINE void records_take(const int32_t *from, uint32_t words, const uint32_t at[LANES], lanes word[4]) {
  const lanes a = lanes_four(from, words, at);
  const lanes b = lanes_four(from, words, at + 1);
  const lanes c = lanes_four(from, words, at + 2);
  const lanes d = lanes_four(from, words, at + 3);
  const lanes ab = lanes_mix_low(a, b);
  const lanes cd = lanes_mix_low(c, d);
  const lanes ab_high = lanes_mix_high(a, b);
  const lanes cd_high = lanes_mix_high(c, d);
  word[0] = lanes_twos_low(ab, cd);
  word[1] = lanes_twos_high(ab, cd);
  word[2] = lanes_twos_low(ab_high, cd_high);
  word[3] = lanes_twos_high(ab_high, cd_high);
}

/* The other way round: record 4 b + n stands in lanes 4 b to 4 b + 3 of group[n]. */
LANES_INLINE void records_split(const lanes word[4], lanes group[4]) {
  const lanes xy = lanes_mix_low(word[0], word[1]);
  const lanes zw = lanes_mix_low(word[2], word[3]);
  const lanes xy_high = lanes_mix_high(word[0], word[1]);
  const lanes zw_high = lanes_mix_high(word[2], word[3]);
  group[0] = lanes_twos_low(xy, zw);
  group[1] = lanes_twos_high(xy, zw);
  group[2] = lanes_twos_low(xy_high, zw_high);
  group[3] = lanes_twos_high(xy_high, zw_high);
}

/* Adds the first three words to records of four; lanes may name the same record. */
LANES_INLINE void records_add(int32_t *to, const uint32_t at[LANES], uint32_t count, const lanes word[4]) {
  lanes group[4];
  int32_t words[4][LANES];
  records_split(word, group);
  LONGS_UNROLLED
  for (int n = 0; n < 4; ++n) lanes_store(words[n], group[n]);
  for (uint32_t n = 0; n < count; ++n) {
    __m128i *record = (__m128i *)(void *)(to + 4u * at[n]);
    const __m128i more = _mm_loadu_si128((const __m128i *)(const void *)&words[n % 4u][n & ~3u]);
    _mm_storeu_si128(record, _mm_add_epi32(_mm_loadu_si128(record), more));
  }
}

/* Puts them at to, one after the other. */
LANES_INLINE void records_put(int32_t *to, const lanes word[4]) {
  lanes group[4];
  int32_t words[4][LANES];
  records_split(word, group);
  LONGS_UNROLLED
  for (int n = 0; n < 4; ++n) lanes_store(words[n], group[n]);
  LONGS_UNROLLED
  for (int n = 0; n < LANES; ++n)
    _mm_storeu_si128((__m128i *)(void *)(to + 4 * n), _mm_loadu_si128((const __m128i *)(const void *)&words[n % 4][n & ~3]));
}

/* Along an axis from one particle to another, at most so far. */
LANES_INLINE lanes records_way(const int32_t *at, const uint32_t from[LANES], const uint32_t to[LANES], int32_t most) {
  return lanes_clamp(lanes_sub(lanes_of(at, to), lanes_of(at, from)), most);
}

/* Takes groups of LANES from `first` on, until one is left to the scalar code; returns how many records it took. */
#define RECORDS_GROUPS(name, view, group)                                                       \
  LANES_INLINE uint32_t name(const view *v, uint32_t first, uint32_t end) {                     \
    uint32_t at = first;                                                                        \
    while (at < end) {                                                                          \
      const uint32_t count = end - at < (uint32_t)LANES ? end - at : (uint32_t)LANES;           \
      if (!group(v, at, count)) break;                                                          \
      at += count;                                                                              \
    }                                                                                           \
    return at - first;                                                                          \
  }
#endif

#endif
