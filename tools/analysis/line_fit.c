/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/analysis/line_fit.h"

line_fit line_through(const double *x, const double *y, size_t count) {
  double mean_x = 0;
  double mean_y = 0;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (size_t n = 0; n < count; ++n) {
    mean_x += x[n] / (double)count;
    mean_y += y[n] / (double)count;
  }
  for (size_t n = 0; n < count; ++n) {
    xx += (x[n] - mean_x) * (x[n] - mean_x);
    xy += (x[n] - mean_x) * (y[n] - mean_y);
    yy += (y[n] - mean_y) * (y[n] - mean_y);
  }
  const double slope = xy / xx;
  return (line_fit){slope, mean_y - slope * mean_x, xy * xy / (xx * yy)};
}
