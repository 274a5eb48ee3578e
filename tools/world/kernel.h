/* SPDX-License-Identifier: Apache-2.0 */
/* Kernels by their names on the command line. */
#ifndef FRAY_TOOLS_WORLD_KERNEL_H
#define FRAY_TOOLS_WORLD_KERNEL_H

#include "rt/fray.h"

const char *kernel_name(fray_kernel kernel);
/* Gives a world the kernel of that name, or the fastest for NULL. Returns 0 after a message that
 * lists what this machine and build have. */
int kernel_use(fray_world *world, const char *name);

#endif
