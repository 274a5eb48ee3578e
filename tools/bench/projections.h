/* SPDX-License-Identifier: Apache-2.0 */
/* Time of a projection: fray's kernels and the float loops on the same structural rows, all from
 * the same positions, those that a substep has predicted. */
#ifndef FRAY_TOOLS_BENCH_PROJECTIONS_H
#define FRAY_TOOLS_BENCH_PROJECTIONS_H

#include "tools/bench/kernels.h"
#include "tools/bench/min_median.h"

typedef enum { LOOP_PLAIN, LOOP_COLOURED, LOOP_RECORDS, LOOP_ARRAYS, LOOPS } float_loop_name;

typedef struct {
  min_median fray[KERNELS_MAX]; /* ns per projection, by place in `kernels` */
  min_median loop[LOOPS];       /* 0 where the machine lacks it, or it cannot take these rows */
  double ratio[KERNELS_MAX][LOOPS]; /* fray by loop within a round, median of the rounds; or 0 */
  uint32_t rows, springs_in_runs;
} projection_times;

extern const char *const loop_names[LOOPS];  /* for people */
extern const char *const loop_keys[LOOPS];   /* for programs */

/* Moves the world. Returns 0 iff memory is out. */
int projections_time(fray_world *world, const kernels *k, projection_times *t);

/* Leaves only those batches whose rows lie in runs of RUN_MEAN and more on average, by making the
 * others idle in the opened image; returns how many rows are left. */
enum { RUN_MEAN = 16 };
uint32_t projections_keep_runs(struct world_file *o);

#endif
