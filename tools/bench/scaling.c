/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/scaling.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/bench/woven_sample.h"
#include "tools/bench/timed_tick.h"
#include "tools/terminal/progress.h"

/* Ticks of a round; before them come some that are not counted. */
enum { ROUNDS = 9, WARM_UP = 2, TICKS_MIN = 5, TICKS_MAX = 40, CROSSINGS_TIMED = 400000 };

/* Twice as wide as high: 1k to 250k crossings. */
static const uint32_t heights[SCALING_SIZES] = {22, 32, 50, 71, 100, 158, 224, 274, 316, 354};

typedef struct {
  session s;
  double *ns; /* of every tick */
  uint32_t done;
} sample;

static uint32_t ticks_for(uint32_t crossings) {
  const uint32_t ticks = CROSSINGS_TIMED / crossings;
  return ticks < TICKS_MIN ? TICKS_MIN : (ticks > TICKS_MAX ? TICKS_MAX : ticks);
}

/* Returns an exit code. */
static int open_point(const char *kernel, uint32_t height, scaling *g, scaling_point *p, sample *to) {
  kernels k;
  p->warps = 2 * height;
  p->wefts = height;
  p->ticks = ticks_for(p->warps * p->wefts);
  to->ns = malloc(p->ticks * ROUNDS * sizeof *to->ns);
  if (to->ns == NULL || !woven_sample_open(p->warps, p->wefts, &to->s)) return 1;
  if (!kernels_find(&k, to->s.world_file.world, kernel)) return 2;
  g->kernel = kernels_fastest(&k);
  fray_set_kernel(to->s.world_file.world, g->kernel);
  p->memory_bytes = to->s.world_file.memory_bytes;
  p->image_bytes = to->s.world_file.image_bytes;
  return 0;
}

static void time_ticks(sample *to, uint32_t ticks) {
  static const fray_input nothing;
  fray_output out;
  for (uint32_t n = 0; n < WARM_UP; ++n) fray_tick(to->s.world_file.world, &nothing, &out);
  for (uint32_t n = 0; n < ticks; ++n) {
    const double before = timed_cpu_ns();
    fray_tick(to->s.world_file.world, &nothing, &out);
    to->ns[to->done++] = timed_cpu_ns() - before;
  }
}

static int open_all(const char *kernel, scaling *g, sample *samples) {
  int code = 0;
  for (uint32_t n = 0; code == 0 && n < SCALING_SIZES; ++n) {
    progress_show("cloths", n, SCALING_SIZES);
    code = open_point(kernel, heights[n], g, &g->points[n], &samples[n]);
  }
  return code;
}

static void fit_lines(scaling *g, sample *samples) {
  double crossings[SCALING_SIZES];
  double min[SCALING_SIZES];
  double median[SCALING_SIZES];
  for (uint32_t n = 0; n < SCALING_SIZES; ++n) {
    scaling_point *p = &g->points[n];
    p->tick_ns = min_median_of(samples[n].ns, samples[n].done);
    crossings[n] = (double)p->warps * p->wefts;
    min[n] = p->tick_ns.min;
    median[n] = p->tick_ns.median;
  }
  g->min = line_through(crossings, min, SCALING_SIZES);
  g->median = line_through(crossings, median, SCALING_SIZES);
}

int scaling_measure(const char *kernel, scaling *g) {
  sample samples[SCALING_SIZES];
  memset(samples, 0, sizeof samples);
  memset(g, 0, sizeof *g);
  const int code = open_all(kernel, g, samples);
  for (uint32_t round = 0; code == 0 && round < ROUNDS; ++round)
    for (uint32_t n = 0; n < SCALING_SIZES; ++n) {
      progress_show("ticks of all cloths", round * SCALING_SIZES + n, ROUNDS * SCALING_SIZES);
      time_ticks(&samples[n], g->points[n].ticks);
    }
  progress_end();
  if (code == 0) fit_lines(g, samples);
  if (code == 1) fprintf(stderr, "fray bench: not enough memory for the cloths\n");
  for (uint32_t n = 0; n < SCALING_SIZES; ++n) {
    session_close(&samples[n].s);
    free(samples[n].ns);
  }
  return code;
}
