/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/world/kernel.h"

#include <stdio.h>
#include <string.h>

#include "platform/linux/cpu.h"

static const char *const names[] = {"scalar", "avx2", "avx512", "neon", "helium"};
enum { KERNELS = sizeof names / sizeof *names };

const char *kernel_name(fray_kernel kernel) { return names[kernel]; }

int kernel_use(fray_world *world, const char *name) {
  if (name == NULL) {
    cpu_use_best(world);
    return 1;
  }
  for (int n = 0; n < KERNELS; ++n)
    if (strcmp(name, names[n]) == 0 && cpu_has((fray_kernel)n) && fray_set_kernel(world, (fray_kernel)n))
      return 1;
  fprintf(stderr, "--kernel %s: expected one that this build and this machine have:", name);
  for (int n = 0; n < KERNELS; ++n)
    if (cpu_has((fray_kernel)n) && fray_set_kernel(world, (fray_kernel)n))
      fprintf(stderr, " %s", names[n]);
  fprintf(stderr, "\n");
  return 0;
}
