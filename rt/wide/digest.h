/* SPDX-License-Identifier: Apache-2.0 */
/* The hash of rt/base/hash.h, its eight lanes at once. */
#ifndef FRAY_WIDE_DIGEST_H
#define FRAY_WIDE_DIGEST_H

#include "rt/base/hash.h"

typedef uint32_t digest_lanes __attribute__((vector_size(4 * HASH_LANES)));

static inline void digest_load(void *to, const void *from, size_t bytes) {
  __builtin_memcpy(to, from, bytes);
}

static inline digest_lanes digest_step(digest_lanes lane, digest_lanes word) {
  const digest_lanes v = (lane ^ word) * 0x9E3779B1u;
  return v << 15 | v >> 17;
}

/* Three hashes side by side: a step waits long for the one before it. Whole rounds of lanes; returns how
 * many elements of each they took. */
static inline uint32_t digest_of_words(hash h[3], const int32_t *const words[3], uint32_t count) {
  digest_lanes lane[3];
  uint32_t n = 0;
  for (int a = 0; a < 3; ++a) digest_load(&lane[a], h[a].lane, sizeof lane[a]);
  for (; n + HASH_LANES <= count; n += HASH_LANES)
    for (int a = 0; a < 3; ++a) {
      digest_lanes word;
      digest_load(&word, words[a] + n, sizeof word);
      lane[a] = digest_step(lane[a], word);
    }
  for (int a = 0; a < 3; ++a) digest_load(h[a].lane, &lane[a], sizeof lane[a]);
  return n;
}

static inline uint32_t digest_of_bytes(hash h[3], const int8_t *const bytes[3], uint32_t count) {
  digest_lanes lane[3];
  uint32_t n = 0;
  for (int a = 0; a < 3; ++a) digest_load(&lane[a], h[a].lane, sizeof lane[a]);
  for (; n + HASH_LANES <= count; n += HASH_LANES)
    for (int a = 0; a < 3; ++a) {
      int32_t eight[HASH_LANES];
      digest_lanes word;
      for (int k = 0; k < HASH_LANES; ++k) eight[k] = bytes[a][n + (uint32_t)k];
      digest_load(&word, eight, sizeof word);
      lane[a] = digest_step(lane[a], word);
    }
  for (int a = 0; a < 3; ++a) digest_load(h[a].lane, &lane[a], sizeof lane[a]);
  return n;
}

#endif
