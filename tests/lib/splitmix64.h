/* SPDX-License-Identifier: Apache-2.0 */
/* Tests need random numbers that are the same everywhere. */
#ifndef FRAY_TESTS_LIB_SPLITMIX64_H
#define FRAY_TESTS_LIB_SPLITMIX64_H

#include <stdint.h>

static inline uint64_t splitmix64(uint64_t *seed) {
  uint64_t v = *seed += 0x9E3779B97F4A7C15u;
  v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9u;
  v = (v ^ (v >> 27)) * 0x94D049BB133111EBu;
  return v ^ (v >> 31);
}

#endif
