/* SPDX-License-Identifier: Apache-2.0 */
/* SIMD kernels that this processor can run. */
#ifndef FRAY_PLATFORM_LINUX_CPU_H
#define FRAY_PLATFORM_LINUX_CPU_H

#include "rt/fray.h"

/* Returns 1 iff this processor has a kernel's instructions; fray_set_kernel() says whether the build has
 * it. */
int cpu_has(fray_kernel kernel);
/* Sets a world's kernel to the fastest that processor and build have, and returns it. */
fray_kernel cpu_use_best(fray_world *world);

#endif
