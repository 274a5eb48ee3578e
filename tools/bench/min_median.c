/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/min_median.h"

#include <stdlib.h>

static int by_size(const void *a, const void *b) {
  const double x = *(const double *)a;
  const double y = *(const double *)b;
  return (x > y) - (x < y);
}

min_median min_median_of(double *values, uint32_t count) {
  qsort(values, count, sizeof *values, by_size);
  return (min_median){values[0], values[count / 2]};
}
