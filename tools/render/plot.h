/* SPDX-License-Identifier: Apache-2.0 */
/* Line plots. Any number of points a series: each pixel column shows its least and greatest. */
#ifndef FRAY_TOOLS_RENDER_PLOT_H
#define FRAY_TOOLS_RENDER_PLOT_H

#include <stddef.h>
#include <stdint.h>

#include "tools/render/canvas.h"

enum { PLOT_SERIES_MAX = 8, PLOT_TICKS_MAX = 12 };

typedef struct {
  const char *label;
  const double *y; /* [plot.points]; not finite: a gap */
  uint32_t colour; /* sRGB */
} plot_series;

typedef struct {
  double x;
  const char *label; /* NULL: none; labels that would overlap are left out */
} plot_mark;

/* Point k is at x_first + k * x_step. */
typedef struct {
  const char *title, *x_label, *y_label;
  double x_first, x_step;
  size_t points;
  plot_series series[PLOT_SERIES_MAX];
  uint32_t series_count;
  const plot_mark *marks;
  size_t mark_count;
  int y_from_zero; /* the axis includes 0, for amounts */
} plot;

typedef struct {
  float x0, y0, x1, y1;
} plot_area;

/* Ticks at first, first + step, ...: `count` of them (at most `most`, 2..12) within [low, high],
 * step 1, 2 or 5 times a power of ten. `decimals`: how many make them exact. */
typedef struct {
  double first, step;
  uint32_t count;
  int decimals;
} plot_ticks;
plot_ticks plot_choose_ticks(double low, double high, uint32_t max);

/* Least and greatest of y in each of `columns` equal parts of 0..points-1; the part's first point
 * is shared with the part before, so that the drawn line has no gaps. Empty: low > high. */
void plot_columns(const double *y, size_t points, uint32_t columns, double *low, double *high);

/* Eight colours that stay apart. */
uint32_t plot_colour(uint32_t n);

void plot_draw(canvas *c, plot_area area, const plot *p);

#endif
