/* SPDX-License-Identifier: Apache-2.0 */
/* Figures taken in rounds, each contestant once a round, so that a neighbour who takes the machine
 * for a while meets all of them: the least of the rounds, and the median. */
#ifndef FRAY_BENCH_ROUNDS_H
#define FRAY_BENCH_ROUNDS_H

#include <stdint.h>

typedef struct {
  double least, median;
} spread;

/* Sorts `values`. */
spread spread_of(double *values, uint32_t count);

#endif
