/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels that a bench runs, and worlds made again from the same image. */
#ifndef FRAY_TOOLS_BENCH_KERNELS_H
#define FRAY_TOOLS_BENCH_KERNELS_H

#include "tools/world/world_file.h"

enum { KERNELS_MAX = 8 };

typedef struct {
  fray_kernel list[KERNELS_MAX];
  uint32_t count;
} kernels;

/* All that this build and this machine have, the scalar one first; or the one of that name. Returns
 * 0 after a message to stderr. The world's own kernel stays. */
int kernels_find(kernels *k, fray_world *world, const char *name);
fray_kernel kernels_fastest(const kernels *k);

/* A second world from the image of the first, as it was at its start; 0 iff memory is out. */
int kernels_reopen_world(const struct world_file *from, struct world_file *to);

#endif
