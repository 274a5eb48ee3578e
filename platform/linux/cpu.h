/* SPDX-License-Identifier: Apache-2.0 */
/* What the processor can do. */
#ifndef FRAY_PLATFORM_LINUX_CPU_H
#define FRAY_PLATFORM_LINUX_CPU_H

#include "rt/fray.h"

/* Whether this processor has a kernel's instructions; that the build has it is for fray_use(). */
int cpu_has(fray_kernel kernel);
/* Gives a world the fastest kernel that both have; returns which. */
fray_kernel cpu_use_best(fray_world *world);

#endif
