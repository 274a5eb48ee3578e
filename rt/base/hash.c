/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/base/hash.h"

#include <stddef.h>

#if FX_NARROW
/* Lanes are independent: one at a time stays in a register. */
void hash_words(hash *h, const int32_t *words, uint32_t count) {
  FRAY_ASSERT(words != NULL || count == 0);
  for (uint32_t k = 0; k < HASH_LANES; ++k) {
    uint32_t lane = h->lane[k];
    uint32_t n = k;
    for (; n + HASH_LANES < count; n += 2 * HASH_LANES) {
      lane = hash_step(lane, (uint32_t)words[n]);
      lane = hash_step(lane, (uint32_t)words[n + HASH_LANES]);
    }
    h->lane[k] = n < count ? hash_step(lane, (uint32_t)words[n]) : lane;
  }
}

void hash_bytes(hash *h, const int8_t *bytes, uint32_t count) {
  FRAY_ASSERT(bytes != NULL || count == 0);
  for (uint32_t k = 0; k < HASH_LANES; ++k) {
    uint32_t lane = h->lane[k];
    uint32_t n = k;
    for (; n + HASH_LANES < count; n += 2 * HASH_LANES) {
      lane = hash_step(lane, (uint32_t)(int32_t)bytes[n]);
      lane = hash_step(lane, (uint32_t)(int32_t)bytes[n + HASH_LANES]);
    }
    h->lane[k] = n < count ? hash_step(lane, (uint32_t)(int32_t)bytes[n]) : lane;
  }
}
#else
void hash_words(hash *h, const int32_t *words, uint32_t count) {
  FRAY_ASSERT(words != NULL || count == 0);
  uint32_t n = 0;
  for (; n + HASH_LANES <= count; n += HASH_LANES)
    for (uint32_t k = 0; k < HASH_LANES; ++k)
      h->lane[k] = hash_step(h->lane[k], (uint32_t)words[n + k]);
  for (; n < count; ++n)
    h->lane[n % HASH_LANES] = hash_step(h->lane[n % HASH_LANES], (uint32_t)words[n]);
}

void hash_bytes(hash *h, const int8_t *bytes, uint32_t count) {
  FRAY_ASSERT(bytes != NULL || count == 0);
  uint32_t n = 0;
  for (; n + HASH_LANES <= count; n += HASH_LANES)
    for (uint32_t k = 0; k < HASH_LANES; ++k)
      h->lane[k] = hash_step(h->lane[k], (uint32_t)(int32_t)bytes[n + k]);
  for (; n < count; ++n)
    h->lane[n % HASH_LANES] = hash_step(h->lane[n % HASH_LANES], (uint32_t)(int32_t)bytes[n]);
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
