/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/base/hash.h"

#if FX_NARROW
/* Lanes are independent: one at a time stays in a register. All of them, whatever was asked for. */
void hash_words(hash *h, const int32_t *words, uint32_t count) {
  for (uint32_t k = 0; k < HASH_LANES; ++k) {
    uint32_t lane = h->lane[k];
    for (uint32_t n = k; n < count; n += HASH_LANES) lane = hash_step(lane, (uint32_t)words[n]);
    h->lane[k] = lane;
  }
}

void hash_bytes(hash *h, const int8_t *bytes, uint32_t count) {
  for (uint32_t k = 0; k < HASH_LANES; ++k) {
    uint32_t lane = h->lane[k];
    for (uint32_t n = k; n < count; n += HASH_LANES)
      lane = hash_step(lane, (uint32_t)(int32_t)bytes[n]);
    h->lane[k] = lane;
  }
}
#else
/* `lanes` is a constant where it is called: the lanes stay in registers. */
__attribute__((always_inline)) static inline void take_words(hash *h, uint32_t lanes,
                                                             const int32_t *words, uint32_t count) {
  uint32_t *lane = h->lane + h->first;
  uint32_t n = h->first;
  for (; n + lanes <= count; n += HASH_LANES)
    for (uint32_t k = 0; k < lanes; ++k) lane[k] = hash_step(lane[k], (uint32_t)words[n + k]);
  for (uint32_t k = 0; n + k < count && k < lanes; ++k)
    lane[k] = hash_step(lane[k], (uint32_t)words[n + k]);
}

__attribute__((always_inline)) static inline void take_bytes(hash *h, uint32_t lanes,
                                                             const int8_t *bytes, uint32_t count) {
  uint32_t *lane = h->lane + h->first;
  uint32_t n = h->first;
  for (; n + lanes <= count; n += HASH_LANES)
    for (uint32_t k = 0; k < lanes; ++k)
      lane[k] = hash_step(lane[k], (uint32_t)(int32_t)bytes[n + k]);
  for (uint32_t k = 0; n + k < count && k < lanes; ++k)
    lane[k] = hash_step(lane[k], (uint32_t)(int32_t)bytes[n + k]);
}

void hash_words(hash *h, const int32_t *words, uint32_t count) {
  const uint32_t lanes = h->end - h->first;
  if (lanes == HASH_LANES)
    take_words(h, HASH_LANES, words, count);
  else if (lanes == HASH_LANES / 2)
    take_words(h, HASH_LANES / 2, words, count);
  else
    take_words(h, lanes, words, count);
}

void hash_bytes(hash *h, const int8_t *bytes, uint32_t count) {
  const uint32_t lanes = h->end - h->first;
  if (lanes == HASH_LANES)
    take_bytes(h, HASH_LANES, bytes, count);
  else if (lanes == HASH_LANES / 2)
    take_bytes(h, HASH_LANES / 2, bytes, count);
  else
    take_bytes(h, lanes, bytes, count);
}
#endif

FX_WRAPS uint64_t hash_end(const hash *h) {
  uint64_t total = 0x13198A2E03707344u;
  for (uint32_t n = 0; n < HASH_LANES; ++n) {
    total = (total ^ h->lane[n]) * 0xFF51AFD7ED558CCDu;
    total ^= total >> 32;
  }
  return total;
}

FX_WRAPS uint64_t hash_entry(uint32_t field, uint32_t id, uint32_t value) {
  uint64_t v = ((uint64_t)id << 32 | value) + field * 0x9E3779B97F4A7C15u;
  v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9u;
  v = (v ^ (v >> 27)) * 0x94D049BB133111EBu;
  return v ^ (v >> 31);
}
