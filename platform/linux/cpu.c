/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/linux/cpu.h"

int cpu_has(fray_kernel kernel) {
  switch (kernel) {
    case FRAY_KERNEL_SCALAR:
      return 1;
#if defined(__x86_64__)
    case FRAY_KERNEL_AVX2:
      return __builtin_cpu_supports("avx2") != 0;
    case FRAY_KERNEL_AVX512:
      return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#elif defined(__ARM_NEON)
    case FRAY_KERNEL_NEON:
      return 1;
#endif
    default:
      return 0;
  }
}

fray_kernel cpu_use_best(fray_world *world) {
  static const fray_kernel fastest_first[] = {FRAY_KERNEL_AVX512, FRAY_KERNEL_AVX2,
                                              FRAY_KERNEL_NEON};
  for (unsigned n = 0; n < sizeof fastest_first / sizeof *fastest_first; ++n)
    if (cpu_has(fastest_first[n]) && fray_set_kernel(world, fastest_first[n])) return fastest_first[n];
  return FRAY_KERNEL_SCALAR;
}
