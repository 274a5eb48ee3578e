/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/report_run.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/render/plot.h"

enum { WIDTH = 1280, PANEL = 300, PANELS_MAX = 3, SAMPLES = 2 };

/* 0.5 mN a step. */
static const float newtons = 0.0005f;

void run_trace_open(run_trace *t, uint32_t rate_hz, uint32_t hands) {
  memset(t, 0, sizeof *t);
  t->rate_hz = rate_hz ? rate_hz : 1;
  t->hands = hands;
}

void run_trace_close(run_trace *t) {
  free(t->samples);
  memset(t, 0, sizeof *t);
}

void run_trace_add(run_trace *t, const fray_output *output) {
  if (t->failed) return;
  if (t->count == t->room) {
    const size_t room = t->room ? 2 * t->room : 4096;
    run_sample *grown = realloc(t->samples, room * sizeof *grown);
    if (!grown) {
      t->failed = 1;
      return;
    }
    t->samples = grown;
    t->room = room;
  }
  if (t->count == 0) t->first_tick = output->tick;
  run_sample *s = t->samples + t->count++;
  s->work = output->work;
  for (int h = 0; h < FRAY_HANDS; h++)
    for (int a = 0; a < 3; a++) s->force[h][a] = (float)output->force[h][a] * newtons;
}

typedef enum {
  FORCE_X,
  FORCE_Y,
  FORCE_Z,
  FORCE_SIZE,
  WORK_PREDICTIONS,
  WORK_PROJECTIONS,
  WORK_SPRINGS,
  WORK_TEAR_TESTS,
  WORK_CONTACTS,
  WORK_CUTS,
  QUANTITIES
} quantity;

static const char *const names[QUANTITIES] = {
    "x", "y", "z", "magnitude", "predictions", "projections", "bend and shear", "tear tests",
    "candidate contacts", "springs cut"};

static double value_of(const run_sample *s, quantity q, int hand) {
  const float *f = s->force[hand];
  switch (q) {
    case FORCE_X: return (double)f[0];
    case FORCE_Y: return (double)f[1];
    case FORCE_Z: return (double)f[2];
    case FORCE_SIZE: return sqrt((double)f[0] * f[0] + (double)f[1] * f[1] + (double)f[2] * f[2]);
    case WORK_PREDICTIONS: return s->work.predictions;
    case WORK_PROJECTIONS: return s->work.projections;
    case WORK_SPRINGS: return s->work.springs;
    case WORK_TEAR_TESTS: return s->work.tear_tests;
    case WORK_CONTACTS: return s->work.contacts;
    case WORK_CUTS: return s->work.cuts;
    case QUANTITIES: break;
  }
  return 0.0;
}

typedef struct {
  const char *title, *y_label;
  int hand, amounts;
  uint32_t count;
  quantity quantities[4];
} panel;

static double second(const run_trace *t, size_t sample) {
  return ((double)t->first_tick + (double)sample + 1.0) / t->rate_hz; /* the end of its tick */
}

/* A mark where cuts begin after a tick without any; NULL if there are none or no memory. */
static plot_mark *cut_marks(const run_trace *t, size_t *count) {
  *count = 0;
  for (size_t k = 0; k < t->count; k++)
    if (t->samples[k].work.cuts && (k == 0 || !t->samples[k - 1].work.cuts)) ++*count;
  plot_mark *marks = *count ? calloc(*count, sizeof *marks) : NULL;
  if (!marks) {
    *count = 0;
    return NULL;
  }
  size_t n = 0;
  for (size_t k = 0; k < t->count; k++)
    if (t->samples[k].work.cuts && (k == 0 || !t->samples[k - 1].work.cuts))
      marks[n++].x = second(t, k);
  marks[0].label = "first cut";
  return marks;
}

static int draw_panel(canvas *c, const run_trace *t, const panel *one, plot_area area, int last,
                      const plot_mark *marks, size_t mark_count) {
  double *values = malloc(one->count * t->count * sizeof *values);
  if (!values) return 0;
  plot p = {.title = one->title,
            .y_label = one->y_label,
            .x_label = last ? "time, s" : NULL,
            .x_first = second(t, 0),
            .x_step = 1.0 / t->rate_hz,
            .points = t->count,
            .series_count = one->count,
            .marks = marks,
            .mark_count = mark_count,
            .y_from_zero = one->amounts};
  for (uint32_t s = 0; s < one->count; s++) {
    double *y = values + s * t->count;
    for (size_t k = 0; k < t->count; k++)
      y[k] = value_of(t->samples + k, one->quantities[s], one->hand);
    p.series[s] = (plot_series){names[one->quantities[s]], y, plot_colour(s)};
  }
  plot_draw(c, area, &p);
  free(values);
  return 1;
}

static int write_panels(const run_trace *t, const panel *panels, uint32_t count, int mark_cuts,
                        const char *path) {
  errno = EINVAL;
  if (t->count == 0 || count == 0) return 0;
  errno = ENOMEM;
  canvas c;
  if (!canvas_open(&c, WIDTH, PANEL * count, SAMPLES)) return 0;
  canvas_fill(&c, rgb_hex(0xFFFFFF), rgb_hex(0xFFFFFF));
  size_t mark_count = 0;
  plot_mark *marks = mark_cuts ? cut_marks(t, &mark_count) : NULL;
  int good = 1;
  for (uint32_t k = 0; k < count; k++) {
    const plot_area area = {0, (float)(PANEL * k), WIDTH, (float)(PANEL * (k + 1))};
    good &= draw_panel(&c, t, panels + k, area, k + 1 == count, marks, mark_count);
  }
  free(marks);
  good = good && canvas_write(&c, path);
  canvas_close(&c);
  return good;
}

int plot_forces_write(const run_trace *t, const char *path) {
  static const panel hands[FRAY_HANDS] = {
      {"force on the left hand", "N", 0, 0, 4, {FORCE_X, FORCE_Y, FORCE_Z, FORCE_SIZE}},
      {"force on the right hand", "N", 1, 0, 4, {FORCE_X, FORCE_Y, FORCE_Z, FORCE_SIZE}}};
  panel shown[FRAY_HANDS];
  uint32_t count = 0;
  for (uint32_t h = 0; h < FRAY_HANDS; h++)
    if (t->hands >> h & 1u) shown[count++] = hands[h];
  return write_panels(t, shown, count, 1, path);
}

int plot_work_write(const run_trace *t, const char *path) {
  static const panel panels[PANELS_MAX] = {
      {"work per tick", "count", 0, 1, 4,
       {WORK_PREDICTIONS, WORK_PROJECTIONS, WORK_SPRINGS, WORK_TEAR_TESTS}},
      {"contacts per tick", "count", 0, 1, 1, {WORK_CONTACTS}},
      {"springs cut per tick", "count", 0, 1, 1, {WORK_CUTS}}};
  return write_panels(t, panels, PANELS_MAX, 0, path);
}
