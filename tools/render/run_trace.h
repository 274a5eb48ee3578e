/* SPDX-License-Identifier: Apache-2.0 */
/* What a run keeps of its outputs for plots: one sample a tick. */
#ifndef FRAY_TOOLS_RENDER_RUN_TRACE_H
#define FRAY_TOOLS_RENDER_RUN_TRACE_H

#include <stddef.h>
#include <stdint.h>

#include "rt/fray.h"

typedef struct {
  float force[FRAY_HANDS][3]; /* N */
  float opening, pull;        /* of the body that has gone farthest: cm, and N that hold it back there */
  float apart;                /* cm between the bodies of both hands; 0 where there are not two */
  fray_work work;
} run_sample;

typedef struct {
  run_sample *samples;
  size_t count, room;
  uint64_t first_tick;
  uint32_t rate_hz;
  uint32_t hands; /* bit h: hand h is used; others are not plotted */
  int failed;     /* memory ran out: samples after that are missing */
  int pulls;      /* 1: some body goes on a path */
  fray_info facts;
  int32_t start[16][3];
  uint32_t hand_body[FRAY_HANDS]; /* that hand h moves */
} run_trace;

void run_trace_open(run_trace *t, uint32_t rate_hz, uint32_t hands);
void run_trace_start(run_trace *t, const fray_world *w);     /* before the first: bodies on paths */
void run_trace_add(run_trace *t, const fray_output *output, const fray_world *w); /* after every tick */
void run_trace_close(run_trace *t);

/* Each writes one PNG. Returns 1, or 0 with errno set (EINVAL: nothing was recorded). Vertical
 * marks show where springs were cut. */
int run_trace_plot_forces(const run_trace *t, const char *path); /* N against s, each hand x y z */
/* Of both hands along one axis, 0 to 2 for x, y, z: N against s. */
int run_trace_plot_tearing(const run_trace *t, uint32_t axis, const char *path);
/* The force that draws what goes on paths apart, N against cm: of the body that goes farthest, and how far.
 * Nothing is written where no body is on a path. */
int run_trace_plot_pull(const run_trace *t, const char *path);
int run_trace_plot_work(const run_trace *t, const char *path);   /* counts per tick against s */

#endif
