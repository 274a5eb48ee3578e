/* SPDX-License-Identifier: Apache-2.0 */
/* The line through points by least squares. */
#ifndef FRAY_TOOLS_ANALYSIS_LINE_FIT_H
#define FRAY_TOOLS_ANALYSIS_LINE_FIT_H

#include <stddef.h>

typedef struct {
  double slope, offset, r2;
} line_fit;

/* Not finite where all x, or all y, are the same. */
line_fit line_through(const double *x, const double *y, size_t count);

#endif
