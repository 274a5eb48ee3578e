/* SPDX-License-Identifier: Apache-2.0 */
/* The wide kernels of this build and machine, and random numbers for what is given to them. */
#ifndef FRAY_TESTS_LIB_SIMD_KERNELS_H
#define FRAY_TESTS_LIB_SIMD_KERNELS_H

#include <stdio.h>

#include "platform/linux/cpu.h"
#include "rt/state/world.h"
#include "tests/lib/splitmix64.h"
#include "tests/lib/test.h"

enum { SIMD_KERNELS = FRAY_KERNEL_HELIUM };

static const char *const simd_kernel_names[] = {"scalar", "avx2", "avx512", "neon", "helium"};

/* Says which of the build's kernels the machine lacks. */
static inline uint32_t simd_kernels(fray_kernel found[SIMD_KERNELS]) {
  fray_world w;
  uint32_t count = 0;
  static int said = 0;
  for (fray_kernel k = FRAY_KERNEL_AVX2; k <= FRAY_KERNEL_HELIUM; ++k) {
    if (!fray_set_kernel(&w, k)) continue;
    if (cpu_has(k))
      found[count++] = k;
    else if (!said)
      printf("not run: kernel %s needs a processor that has it\n", simd_kernel_names[k]);
  }
  said = 1;
  return count;
}

/* Of each kernel: how many rows it took, and that none `of` them, sheets or spans, differ. */
static inline void simd_report(const char *name, const char *of, const fray_kernel *kernels, uint32_t count, uint64_t rows,
                               const uint64_t *different) {
  for (uint32_t k = 0; k < count; ++k) {
    printf("figure %s_as_scalar_%s %llu, %s that differ %llu (asked: 0)\n", name, simd_kernel_names[kernels[k]],
           (unsigned long long)rows, of, (unsigned long long)different[k]);
    CHECK_EQ_INT(different[k], 0);
  }
}

static uint64_t draw_state = 1;

static inline uint32_t draw_word(void) { return (uint32_t)(splitmix64(&draw_state) >> 32); }
static inline uint32_t draw_below(uint32_t n) { return (uint32_t)((uint64_t)draw_word() * n >> 32); }
static inline int32_t draw_between(int32_t low, int32_t high) {
  return (int32_t)(low + (int64_t)((uint64_t)draw_word() * (uint64_t)((int64_t)high - low + 1) >> 32));
}
static inline int32_t draw_either(int32_t a, int32_t b) { return draw_below(2) == 0 ? a : b; }

#endif
