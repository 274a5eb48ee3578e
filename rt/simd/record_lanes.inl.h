/* SPDX-License-Identifier: Apache-2.0 */
/* Records of 32-bit words (array of structs) to lanes and back: a 4 x 4 transpose in every four lanes. */
#ifndef FRAY_SIMD_RECORD_LANES_INL_H
#define FRAY_SIMD_RECORD_LANES_INL_H

#include "rt/simd/lanes64.inl.h"

#ifdef LANES_HAVE_64
/* Lanes 4 b to 4 b + 3 of group[n] are record 4 b + n; its own inverse. */
LANES_INLINE void record_lanes_transpose(const lanes word[4], lanes group[4]) {
  const lanes xy = lanes_unpack_low(word[0], word[1]);
  const lanes zw = lanes_unpack_low(word[2], word[3]);
  const lanes xy_high = lanes_unpack_high(word[0], word[1]);
  const lanes zw_high = lanes_unpack_high(word[2], word[3]);
  group[0] = lanes_unpack64_low(xy, zw);
  group[1] = lanes_unpack64_high(xy, zw);
  group[2] = lanes_unpack64_low(xy_high, zw_high);
  group[3] = lanes_unpack64_high(xy_high, zw_high);
}

/* word[k], lane n = word k of record at[n], for k = 0..3; records are `words` words apart. */
LANES_INLINE void record_lanes_load(const int32_t *from, uint32_t words, const uint32_t at[LANES],
                                    lanes word[4]) {
  const lanes group[4] = {lanes_load_records(from, words, at), lanes_load_records(from, words, at + 1),
                          lanes_load_records(from, words, at + 2), lanes_load_records(from, words, at + 3)};
  record_lanes_transpose(group, word);
}

/* Record n at words[n % 4] + n / 4 * 4. */
LANES_INLINE void record_lanes_spread(const lanes word[4], int32_t words[4][LANES]) {
  lanes group[4];
  record_lanes_transpose(word, group);
  LANES_UNROLL
  for (int n = 0; n < 4; ++n) lanes_store(words[n], group[n]);
}

/* Adds word[0..3] to the 4-word records at[0..count-1]; lanes may name the same record. */
LANES_INLINE void record_lanes_add(int32_t *to, const uint32_t at[LANES], uint32_t count,
                                   const lanes word[4]) {
  int32_t words[4][LANES];
  record_lanes_spread(word, words);
  for (uint32_t n = 0; n < count; ++n) {
    __m128i *record = (__m128i *)(void *)(to + (size_t)4 * at[n]);
    const __m128i more = _mm_loadu_si128((const __m128i *)(const void *)&words[n % 4u][n & ~3u]);
    _mm_storeu_si128(record, _mm_add_epi32(_mm_loadu_si128(record), more));
  }
}

/* Stores LANES consecutive 4-word records. */
LANES_INLINE void record_lanes_store(int32_t *to, const lanes word[4]) {
  int32_t words[4][LANES];
  record_lanes_spread(word, words);
  LANES_UNROLL
  for (int n = 0; n < LANES; ++n)
    _mm_storeu_si128((__m128i *)(void *)(to + 4 * n),
                     _mm_loadu_si128((const __m128i *)(const void *)&words[n % 4][n & ~3]));
}

/* at[to] - at[from], clamped to +-most. */
LANES_INLINE lanes lanes_difference(const int32_t *at, const uint32_t from[LANES], const uint32_t to[LANES],
                                    int32_t most) {
  return lanes_clamp(lanes_sub(lanes_gather(at, to), lanes_gather(at, from)), most);
}

/* NAME_lanes_run(): groups of LANES from `first` on, until one is left to the scalar code. The code of whole
 * groups has no counts in it. */
#define LANES_RUN_GROUPS(name, view, group) \
  LANES_INLINE uint32_t name(const view *v, uint32_t first, uint32_t end) { \
    FRAY_ASSERT(first <= end); \
    uint32_t at = first; \
    while (end - at >= (uint32_t)LANES && group(v, at, (uint32_t)LANES)) at += (uint32_t)LANES; \
    if (at < end && end - at < (uint32_t)LANES && group(v, at, end - at)) at = end; \
    return at - first; \
  }
/* The same without the last group, where it is not whole. */
#define LANES_RUN_WHOLE_GROUPS(name, view, group) \
  LANES_INLINE uint32_t name(const view *v, uint32_t first, uint32_t end) { \
    FRAY_ASSERT(first <= end); \
    uint32_t at = first; \
    while (end - at >= (uint32_t)LANES && group(v, at)) at += (uint32_t)LANES; \
    return at - first; \
  }
#endif

#endif
