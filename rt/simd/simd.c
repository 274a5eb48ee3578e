/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/simd/simd.h"

#include "rt/state/world.h"

const link_words simd_link_words = {1 << (LINK_SHIFT - 1), LINK_HI_MAX,   -LINK_HI_MAX,
                                    16,                    1 << 10,       LINK_U_LEAST,
                                    LINK_PSI_2,            LINK_HORNER_1, LINK_HORNER_0,
                                    1 << 12,               1 << (19 - LINK_SHIFT)};

#define SIMD_IS(SET, set) kernel == FRAY_KERNEL_##SET ||

int fray_set_kernel(fray_world *world, fray_kernel kernel) {
  FRAY_ASSERT(world != NULL);
  if (!(SIMD_SETS(SIMD_IS) kernel == FRAY_KERNEL_SCALAR)) return 0;
  world->kernel = kernel;
  return 1;
}
