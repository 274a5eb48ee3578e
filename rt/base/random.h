/* SPDX-License-Identifier: Apache-2.0 */
/* Stateless random numbers: a function of (seed, element), independent of the order of calls. */
#ifndef FRAY_BASE_RANDOM_H
#define FRAY_BASE_RANDOM_H

#include "rt/base/fx.h"

/* 32 well-mixed bits. Multiply-xorshift rounds; bijective in `element` for a fixed seed. */
FX_WRAPS static inline uint32_t random_bits(uint32_t seed, uint32_t element) {
  uint32_t v = element + seed * 0x9E3779B9u;
  v = (v ^ (v >> 16)) * 0x21F0AAADu;
  v = (v ^ (v >> 15)) * 0xD35A2D97u;
  v = v ^ (v >> 15);
  v = (v + (seed ^ 0x85EBCA6Bu)) * 0xC2B2AE35u;
  return v ^ (v >> 16);
}
/* Uniform in [low, high], both in the caller's format. */
static inline int32_t random_between(uint32_t seed, uint32_t element, int32_t low, int32_t high) {
  FRAY_ASSERT(low <= high);
  const uint32_t span = (uint32_t)fx_sub(high, low) + 1u;
  return fx_add(low, (int32_t)(fx_mul_wide_u(random_bits(seed, element), span) >> 32));
}

#endif
