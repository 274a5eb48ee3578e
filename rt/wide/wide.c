/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/wide/wide.h"

#include "rt/model/world.h"

#define WIDE_IS(SET, set) kernel == FRAY_KERNEL_##SET ||

int fray_use(fray_world *world, fray_kernel kernel) {
  if (!(WIDE_SETS(WIDE_IS) kernel == FRAY_KERNEL_SCALAR)) return 0;
  world->kernel = kernel;
  return 1;
}
