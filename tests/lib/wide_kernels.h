/* SPDX-License-Identifier: Apache-2.0 */
/* The wide kernels of this build and machine, and random numbers for what is given to them. */
#ifndef FRAY_TESTS_WIDE_KERNELS_H
#define FRAY_TESTS_WIDE_KERNELS_H

#include <stdio.h>

#include "platform/linux/cpu.h"
#include "rt/model/world.h"

enum { WIDE_KERNELS = FRAY_KERNEL_HELIUM };

static const char *const wide_kernel_names[] = {"scalar", "avx2", "avx512", "neon", "helium"};

/* Says which of the build's kernels the machine lacks. */
static inline uint32_t wide_kernels(fray_kernel found[WIDE_KERNELS]) {
  fray_world w;
  uint32_t count = 0;
  static int said = 0;
  for (fray_kernel k = FRAY_KERNEL_AVX2; k <= FRAY_KERNEL_HELIUM; ++k) {
    if (!fray_use(&w, k)) continue;
    if (cpu_has(k))
      found[count++] = k;
    else if (!said)
      printf("not run: kernel %s needs a processor that has it\n", wide_kernel_names[k]);
  }
  said = 1;
  return count;
}

static uint64_t random_state = 1;

static inline uint32_t random_word(void) {
  uint64_t v = random_state += 0x9E3779B97F4A7C15u;
  v = (v ^ (v >> 30)) * 0xBF58476D1CE4E5B9u;
  v = (v ^ (v >> 27)) * 0x94D049BB133111EBu;
  return (uint32_t)((v ^ (v >> 31)) >> 32);
}
static inline uint32_t below(uint32_t n) { return (uint32_t)((uint64_t)random_word() * n >> 32); }
static inline int32_t between(int32_t low, int32_t high) {
  return (int32_t)(low + (int64_t)((uint64_t)random_word() * (uint64_t)((int64_t)high - low + 1) >> 32));
}
static inline int32_t either(int32_t a, int32_t b) { return below(2) == 0 ? a : b; }

#endif
