/* SPDX-License-Identifier: Apache-2.0 */
/* The hash of a state: eight multiply-rotate lanes over 32-bit words, value by value, so that
 * byte order and padding have no influence and eight words can be hashed at once.
 * Every step is a bijection of its lane, so a change of any single word changes the hash. */
#ifndef FRAY_BASE_HASH_H
#define FRAY_BASE_HASH_H

#include "rt/base/fx.h"

enum { HASH_LANES = 8 };

typedef struct {
  uint32_t lane[HASH_LANES];
} hash;

static inline void hash_begin(hash *h) {
  for (uint32_t n = 0; n < HASH_LANES; ++n)
    h->lane[n] = 0x243F6A88u ^ fx_wrap_mul_u(n, 0x9E3779B1u);
}
FX_WRAPS static inline uint32_t hash_step(uint32_t lane, uint32_t word) {
  const uint32_t v = fx_wrap_mul_u(lane ^ word, 0x9E3779B1u);
  return v << 15 | v >> 17;
}
/* An array of words: word n goes to lane n % 8. */
void hash_words(hash *h, const int32_t *words, uint32_t count);
/* An array of bytes, each as one signed word. */
void hash_bytes(hash *h, const int8_t *bytes, uint32_t count);
/* Adds the result of another hash, which can be computed independently of this one. */
static inline void hash_join(hash *h, const hash *other) {
  for (uint32_t n = 0; n < HASH_LANES; ++n) h->lane[n] = hash_step(h->lane[n], other->lane[n]);
}
uint64_t hash_end(const hash *h);

/* One entry of a set. The hash of the set is the XOR of its entries, so it can be updated entry by entry. */
uint64_t hash_entry(uint32_t field, uint32_t id, uint32_t value);

#endif
