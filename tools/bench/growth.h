/* SPDX-License-Identifier: Apache-2.0 */
/* Time of a tick and memory against the number of crossings, at fixed substeps, with a line laid
 * through the times by least squares. Times are the thread's own: large sheets need longer than a
 * busy machine leaves a process alone. */
#ifndef FRAY_BENCH_GROWTH_H
#define FRAY_BENCH_GROWTH_H

#include "tools/bench/kernels.h"
#include "tools/bench/rounds.h"

enum { GROWTH_SIZES = 10 };

typedef struct {
  uint32_t warps, wefts, ticks;
  spread tick_ns;
  size_t memory_bytes, image_bytes;
} growth_point;

typedef struct {
  double slope, offset, r2;
} line_fit;

typedef struct {
  fray_kernel kernel;
  growth_point points[GROWTH_SIZES];
  line_fit least, median; /* ns against crossings */
} growth;

line_fit line_through(const double *x, const double *y, uint32_t count);

/* With the kernel of that name, or the fastest for NULL. Returns an exit code after a message. */
int growth_measure(const char *kernel, growth *g);

#endif
