/* SPDX-License-Identifier: Apache-2.0 */
/* Time of a tick and memory against the number of crossings, at fixed substeps, with a line laid
 * through the times by least squares. Times are the thread's own: large sheets need longer than a
 * busy machine leaves a process alone. */
#ifndef FRAY_TOOLS_BENCH_SCALING_H
#define FRAY_TOOLS_BENCH_SCALING_H

#include "tools/analysis/line_fit.h"
#include "tools/bench/kernels.h"
#include "tools/bench/min_median.h"

enum { SCALING_SIZES = 10 };

typedef struct {
  uint32_t warps, wefts, ticks;
  min_median tick_ns;
  size_t memory_bytes, image_bytes;
} scaling_point;

typedef struct {
  fray_kernel kernel;
  scaling_point points[SCALING_SIZES];
  line_fit min, median; /* ns against crossings */
} scaling;

/* With the kernel of that name, or the fastest for NULL. Returns an exit code after a message. */
int scaling_measure(const char *kernel, scaling *g);

#endif
