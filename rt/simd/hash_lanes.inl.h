/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/base/hash.c. The eight lanes of a hash at once, three hashes side by side: each step of a
 * hash depends on the one before. */
#ifndef FRAY_SIMD_HASH_LANES_INL_H
#define FRAY_SIMD_HASH_LANES_INL_H

#include "rt/base/hash.h"

typedef uint32_t hash_lanes __attribute__((vector_size(4 * HASH_LANES)));

static inline void hash_lanes_copy(void *to, const void *from, size_t bytes) {
  __builtin_memcpy(to, from, bytes);
}

static inline hash_lanes hash_lanes_step(hash_lanes lane, hash_lanes word) {
  const hash_lanes v = (lane ^ word) * 0x9E3779B1u;
  return v << 15 | v >> 17;
}

/* Takes whole rounds of HASH_LANES elements; returns how many elements of each array. */
static inline uint32_t hash_words_lanes_run(hash h[3], const int32_t *const words[3], uint32_t count) {
  hash_lanes lane[3];
  uint32_t n = 0;
  for (int a = 0; a < 3; ++a) hash_lanes_copy(&lane[a], h[a].lane, sizeof lane[a]);
  for (; n + HASH_LANES <= count; n += HASH_LANES)
    for (int a = 0; a < 3; ++a) {
      hash_lanes word;
      hash_lanes_copy(&word, words[a] + n, sizeof word);
      lane[a] = hash_lanes_step(lane[a], word);
    }
  for (int a = 0; a < 3; ++a) hash_lanes_copy(h[a].lane, &lane[a], sizeof lane[a]);
  return n;
}

static inline uint32_t hash_bytes_lanes_run(hash h[3], const int8_t *const bytes[3], uint32_t count) {
  hash_lanes lane[3];
  uint32_t n = 0;
  for (int a = 0; a < 3; ++a) hash_lanes_copy(&lane[a], h[a].lane, sizeof lane[a]);
  for (; n + HASH_LANES <= count; n += HASH_LANES)
    for (int a = 0; a < 3; ++a) {
      int32_t eight[HASH_LANES];
      hash_lanes word;
      for (int k = 0; k < HASH_LANES; ++k) eight[k] = bytes[a][n + (uint32_t)k];
      hash_lanes_copy(&word, eight, sizeof word);
      lane[a] = hash_lanes_step(lane[a], word);
    }
  for (int a = 0; a < 3; ++a) hash_lanes_copy(h[a].lane, &lane[a], sizeof lane[a]);
  return n;
}

#endif
