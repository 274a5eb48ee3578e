/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/growth.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/bench/sheets.h"
#include "tools/bench/timed_tick.h"
#include "tools/progress.h"

/* Ticks of a round; before them come some that are not counted. */
enum { ROUNDS = 9, WARM_UP = 2, TICKS_LEAST = 5, TICKS_MOST = 40, CROSSINGS_TIMED = 400000 };

/* Twice as wide as high: 1k to 250k crossings. */
static const uint32_t heights[GROWTH_SIZES] = {22, 32, 50, 71, 100, 158, 224, 274, 316, 354};

line_fit line_through(const double *x, const double *y, uint32_t count) {
  double mean_x = 0;
  double mean_y = 0;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (uint32_t n = 0; n < count; ++n) {
    mean_x += x[n] / count;
    mean_y += y[n] / count;
  }
  for (uint32_t n = 0; n < count; ++n) {
    xx += (x[n] - mean_x) * (x[n] - mean_x);
    xy += (x[n] - mean_x) * (y[n] - mean_y);
    yy += (y[n] - mean_y) * (y[n] - mean_y);
  }
  const double slope = xy / xx;
  return (line_fit){slope, mean_y - slope * mean_x, xy * xy / (xx * yy)};
}

typedef struct {
  session s;
  double *ns; /* of every tick */
  uint32_t done;
} sheet;

static uint32_t ticks_for(uint32_t crossings) {
  const uint32_t ticks = CROSSINGS_TIMED / crossings;
  return ticks < TICKS_LEAST ? TICKS_LEAST : (ticks > TICKS_MOST ? TICKS_MOST : ticks);
}

/* Returns an exit code. */
static int open_point(const char *kernel, uint32_t height, growth *g, growth_point *p, sheet *to) {
  kernels k;
  p->warps = 2 * height;
  p->wefts = height;
  p->ticks = ticks_for(p->warps * p->wefts);
  to->ns = malloc(p->ticks * ROUNDS * sizeof *to->ns);
  if (to->ns == NULL || !sheet_open(p->warps, p->wefts, &to->s)) return 1;
  if (!kernels_find(&k, to->s.opened.world, kernel)) return 2;
  g->kernel = kernels_fastest(&k);
  fray_use(to->s.opened.world, g->kernel);
  p->memory_bytes = to->s.opened.memory_bytes;
  p->image_bytes = to->s.opened.image_bytes;
  return 0;
}

static void time_ticks(sheet *to, uint32_t ticks) {
  static const fray_input nothing;
  fray_output out;
  for (uint32_t n = 0; n < WARM_UP; ++n) fray_tick(to->s.opened.world, &nothing, &out);
  for (uint32_t n = 0; n < ticks; ++n) {
    const double before = timed_cpu_ns();
    fray_tick(to->s.opened.world, &nothing, &out);
    to->ns[to->done++] = timed_cpu_ns() - before;
  }
}

static int open_all(const char *kernel, growth *g, sheet *sheets) {
  int code = 0;
  for (uint32_t n = 0; code == 0 && n < GROWTH_SIZES; ++n) {
    progress_show("sheets", n, GROWTH_SIZES);
    code = open_point(kernel, heights[n], g, &g->points[n], &sheets[n]);
  }
  return code;
}

static void lay_lines(growth *g, sheet *sheets) {
  double crossings[GROWTH_SIZES];
  double least[GROWTH_SIZES];
  double median[GROWTH_SIZES];
  for (uint32_t n = 0; n < GROWTH_SIZES; ++n) {
    growth_point *p = &g->points[n];
    p->tick_ns = spread_of(sheets[n].ns, sheets[n].done);
    crossings[n] = (double)p->warps * p->wefts;
    least[n] = p->tick_ns.least;
    median[n] = p->tick_ns.median;
  }
  g->least = line_through(crossings, least, GROWTH_SIZES);
  g->median = line_through(crossings, median, GROWTH_SIZES);
}

int growth_measure(const char *kernel, growth *g) {
  sheet sheets[GROWTH_SIZES];
  memset(sheets, 0, sizeof sheets);
  memset(g, 0, sizeof *g);
  const int code = open_all(kernel, g, sheets);
  for (uint32_t round = 0; code == 0 && round < ROUNDS; ++round)
    for (uint32_t n = 0; n < GROWTH_SIZES; ++n) {
      progress_show("ticks of all sheets", round * GROWTH_SIZES + n, ROUNDS * GROWTH_SIZES);
      time_ticks(&sheets[n], g->points[n].ticks);
    }
  progress_end();
  if (code == 0) lay_lines(g, sheets);
  if (code == 1) fprintf(stderr, "fray bench: not enough memory for the sheets\n");
  for (uint32_t n = 0; n < GROWTH_SIZES; ++n) {
    session_close(&sheets[n].s);
    free(sheets[n].ns);
  }
  return code;
}
