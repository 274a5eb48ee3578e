/* SPDX-License-Identifier: Apache-2.0 */
/* The hash of rt/base/hash.h, its eight lanes at once. */
#ifndef FRAY_WIDE_DIGEST_H
#define FRAY_WIDE_DIGEST_H

#include "rt/base/hash.h"

typedef uint32_t digest_lanes __attribute__((vector_size(4 * HASH_LANES)));
typedef int32_t digest_words __attribute__((vector_size(4 * HASH_LANES)));
typedef int8_t digest_bytes __attribute__((vector_size(HASH_LANES)));

static inline void digest_load(void *to, const void *from, size_t bytes) {
  __builtin_memcpy(to, from, bytes);
}

/* Whole rounds of lanes; returns how many elements they took. */
static inline uint32_t digest_of_words(hash *h, const int32_t *words, uint32_t count) {
  digest_lanes lane;
  digest_lanes word;
  uint32_t n = 0;
  digest_load(&lane, h->lane, sizeof lane);
  for (; n + HASH_LANES <= count; n += HASH_LANES) {
    digest_load(&word, words + n, sizeof word);
    lane = (lane ^ word) * 0x9E3779B1u;
    lane = lane << 15 | lane >> 17;
  }
  digest_load(h->lane, &lane, sizeof lane);
  return n;
}

static inline uint32_t digest_of_bytes(hash *h, const int8_t *bytes, uint32_t count) {
  digest_lanes lane;
  digest_bytes eight;
  uint32_t n = 0;
  digest_load(&lane, h->lane, sizeof lane);
  for (; n + HASH_LANES <= count; n += HASH_LANES) {
    digest_load(&eight, bytes + n, sizeof eight);
    lane = (lane ^ (digest_lanes)__builtin_convertvector(eight, digest_words)) * 0x9E3779B1u;
    lane = lane << 15 | lane >> 17;
  }
  digest_load(h->lane, &lane, sizeof lane);
  return n;
}

#endif
