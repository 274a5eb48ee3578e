/* SPDX-License-Identifier: Apache-2.0 */
/* What yarns cost where a sheet tears (Metaaphanon 2009, figure 10): time against the number of
 * crossings, and the two-level model beside a sheet that is all yarn. Sheets take ticks in turns; of
 * each tick the least of several runs counts, in the thread's own time. */
#ifndef FRAY_TOOLS_BENCH_YARN_TIMES_H
#define FRAY_TOOLS_BENCH_YARN_TIMES_H

#include <stdio.h>

#include "tools/bench/scaling.h"

enum { YARN_SIZES = 8, YARN_PARTS = 10 };

typedef struct {
  uint32_t warps, wefts, cuts, split;
  double tick_ns; /* mean of all ticks */
} yarn_point;

typedef struct {
  fray_kernel kernel;
  yarn_point points[YARN_SIZES];
  line_fit line; /* ns against crossings */
} yarn_scaling;

typedef struct {
  uint32_t split, cuts;      /* of the two-level sheet, at the end of the part */
  double two_level, all_yarn; /* ns a tick */
} yarn_part;

typedef struct {
  fray_kernel kernel;
  uint32_t warps, wefts, first_split; /* tick, or the number of ticks */
  yarn_part before;                   /* ticks until something splits */
  yarn_part parts[YARN_PARTS];
} yarn_levels;

/* With the kernel of that name, or the fastest for NULL. Each returns an exit code after a message: 1
 * also where a sheet has not torn. */
int yarn_scaling_measure(const char *kernel, yarn_scaling *g);
int yarn_levels_measure(const char *kernel, yarn_levels *l);

void yarn_scaling_print(FILE *out, const yarn_scaling *g);
void yarn_levels_print(FILE *out, const yarn_levels *l);

#endif
