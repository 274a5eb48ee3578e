/* SPDX-License-Identifier: Apache-2.0 */
/* Time of ticks by stage. A run is made several times, with the same inputs: of each tick and stage
 * the least time counts, so that what interrupted one run is not in the figures. Where another
 * process took the processor within a tick, its time is that of the thread. */
#ifndef FRAY_TOOLS_BENCH_PROFILE_H
#define FRAY_TOOLS_BENCH_PROFILE_H

#include "tools/bench/kernels.h"
#include "tools/bench/min_median.h"
#include "tools/bench/tear_phases.h"
#include "tools/bench/timed_tick.h"
#include "tools/recording/session.h"

typedef struct {
  fray_kernel kernel;
  uint32_t ticks, rate_hz, substeps;
  min_median tick_ns;               /* mean of a run's ticks: least tick by tick, median of the runs */
  double worst_ns;              /* the slowest tick, of the least */
  double stage_ns[TIMED_COUNT]; /* a tick */
  double projection_ns;         /* the strain stage by its projections */
  uint32_t work_median, work_worst; /* counted: sum of all kinds */
  uint64_t hash;                /* after the last tick */
  tear_phase phases[TEAR_PHASES]; /* of a membrane that tears; else without ticks */
} profile;

/* One profile for each kernel. Returns 0 iff memory is out. */
int profiles_take(const session *s, const kernels *k, uint32_t ticks, profile *profiles);
double profile_share(const profile *p, double ns); /* of all stages, in percent */
double profile_real_time(const profile *p); /* how many times faster than real time */

#endif
