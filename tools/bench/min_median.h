/* SPDX-License-Identifier: Apache-2.0 */
/* Figures taken in rounds, each contestant once a round, so that load of the machine
 * for a while meets all of them: the least of the rounds, and the median. */
#ifndef FRAY_TOOLS_BENCH_MIN_MEDIAN_H
#define FRAY_TOOLS_BENCH_MIN_MEDIAN_H

#include <stdint.h>

typedef struct {
  double min, median;
} min_median;

/* Sorts `values`. */
min_median min_median_of(double *values, uint32_t count);

#endif
