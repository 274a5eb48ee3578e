/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/run_trace.h"

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

void run_trace_start(run_trace *t, const fray_world *w) {
  t->facts = fray_get_info(w);
  for (uint32_t b = 0; b < t->facts.bodies && b < 16; b++) {
    const fray_body v = fray_view_body(w, b);
    if (v.motion == FRAY_PATH) t->pulls = 1;
    if (v.motion == FRAY_HAND) t->hand_body[v.hand & 1u] = b;
    for (int a = 0; a < 3; a++) t->start[b][a] = v.position[a];
  }
}

/* How far the paths have led: all that is between two bodies that part counts. */
static void add_pull(const run_trace *t, run_sample *s, const fray_world *w) {
  const double cm = t->facts.lu_um * 1e-4 / 16777216.0;
  const double dyn = t->facts.particle_mass_ng * 1e-9 * t->facts.lu_um * 1e-4 / 268435456.0 *
                     t->facts.rate_hz * t->facts.substeps * t->facts.rate_hz;
  double farthest = 0.0, together = 0.0;
  for (uint32_t b = 0; b < t->facts.bodies && b < 16; b++) {
    const fray_body v = fray_view_body(w, b);
    double way[3], square = 0.0, along = 0.0;
    if (v.motion != FRAY_PATH) continue;
    for (int a = 0; a < 3; a++) {
      way[a] = ((double)v.position[a] - t->start[b][a]) * cm;
      square += way[a] * way[a];
    }
    const double length = sqrt(square);
    together += length;
    for (int a = 0; a < 3 && length > 0.0; a++) along += (double)v.impulse[a] * way[a] / length;
    if (length <= farthest) continue;
    farthest = length;
    s->pull = (float)(along * dyn * 1e-5);
  }
  s->opening = (float)together;
}

static double hands_apart(const run_trace *t, const fray_world *w) {
  const fray_body left = fray_view_body(w, t->hand_body[0]), right = fray_view_body(w, t->hand_body[1]);
  double square = 0.0;
  for (int a = 0; a < 3; a++) square += pow((double)left.position[a] - right.position[a], 2.0);
  return sqrt(square) * t->facts.lu_um * 1e-4 / 16777216.0;
}

void run_trace_add(run_trace *t, const fray_output *output, const fray_world *w) {
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
  s->pull = s->opening = s->apart = 0.0f;
  if (t->facts.hands == 3u) s->apart = (float)hands_apart(t, w);
  if (t->pulls) add_pull(t, s, w);
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
  WORK_TEARS,
  QUANTITIES
} quantity;

static const char *const names[QUANTITIES] = {
    "x", "y", "z", "magnitude", "particle steps", "projections", "bend and shear", "tear tests",
    "candidate contacts", "tears"};

static const char *const hand_names[FRAY_HANDS] = {"left hand", "right hand"};

static double value_of(const run_sample *s, quantity q, int hand) {
  const float *f = s->force[hand];
  switch (q) {
    case FORCE_X: return (double)f[0];
    case FORCE_Y: return (double)f[1];
    case FORCE_Z: return (double)f[2];
    case FORCE_SIZE: return sqrt((double)f[0] * f[0] + (double)f[1] * f[1] + (double)f[2] * f[2]);
    case WORK_PREDICTIONS: return s->work.particle_steps;
    case WORK_PROJECTIONS: return s->work.projections;
    case WORK_SPRINGS: return s->work.springs;
    case WORK_TEAR_TESTS: return s->work.tear_tests;
    case WORK_CONTACTS: return s->work.contacts;
    case WORK_TEARS: return s->work.tears;
    case QUANTITIES: break;
  }
  return 0.0;
}

typedef struct {
  const char *title, *y_label;
  int hand, amounts;
  uint32_t count;
  quantity quantities[4];
  int both; /* the first quantity, of both hands */
} panel;

static double second(const run_trace *t, size_t sample) {
  return ((double)t->first_tick + (double)sample + 1.0) / t->rate_hz; /* the end of its tick */
}

/* A mark where cuts begin after a tick without any; NULL if there are none or no memory. */
static plot_mark *cut_marks(const run_trace *t, size_t *count) {
  *count = 0;
  for (size_t k = 0; k < t->count; k++)
    if (t->samples[k].work.tears && (k == 0 || !t->samples[k - 1].work.tears)) ++*count;
  plot_mark *marks = *count ? calloc(*count, sizeof *marks) : NULL;
  if (!marks) {
    *count = 0;
    return NULL;
  }
  size_t n = 0;
  for (size_t k = 0; k < t->count; k++)
    if (t->samples[k].work.tears && (k == 0 || !t->samples[k - 1].work.tears))
      marks[n++].x = second(t, k);
  marks[0].label = "first tear";
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
    const quantity q = one->quantities[one->both ? 0 : s];
    double *y = values + s * t->count;
    for (size_t k = 0; k < t->count; k++) y[k] = value_of(t->samples + k, q, one->both ? (int)s : one->hand);
    p.series[s] = (plot_series){one->both ? hand_names[s] : names[q], y, plot_colour(s)};
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

int run_trace_plot_forces(const run_trace *t, const char *path) {
  static const panel hands[FRAY_HANDS] = {
      {"force on the left hand", "N", 0, 0, 4, {FORCE_X, FORCE_Y, FORCE_Z, FORCE_SIZE}, 0},
      {"force on the right hand", "N", 1, 0, 4, {FORCE_X, FORCE_Y, FORCE_Z, FORCE_SIZE}, 0}};
  panel shown[FRAY_HANDS];
  uint32_t count = 0;
  for (uint32_t h = 0; h < FRAY_HANDS; h++)
    if (t->hands >> h & 1u) shown[count++] = hands[h];
  return write_panels(t, shown, count, 1, path);
}

int run_trace_plot_tearing(const run_trace *t, uint32_t axis, const char *path) {
  static const char *const titles[3] = {"force along x", "force along y", "force along z"};
  const panel one = {titles[axis % 3], "N", 0, 1, FRAY_HANDS, {(quantity)(FORCE_X + axis % 3)}, 1};
  return write_panels(t, &one, 1, 1, path);
}

int run_trace_plot_work(const run_trace *t, const char *path) {
  static const panel panels[PANELS_MAX] = {
      {"work per tick", "count", 0, 1, 4,
       {WORK_PREDICTIONS, WORK_PROJECTIONS, WORK_SPRINGS, WORK_TEAR_TESTS}, 0},
      {"contacts per tick", "count", 0, 1, 1, {WORK_CONTACTS}, 0},
      {"tears per tick", "count", 0, 1, 1, {WORK_TEARS}, 0}};
  return write_panels(t, panels, PANELS_MAX, 0, path);
}

/* Openings as they come: the axis is cut in equal parts, a part shows the mean of its ticks. */
int run_trace_plot_pull(const run_trace *t, const char *path) {
  enum { COLUMNS = 600 };
  static double sum[COLUMNS], count[COLUMNS];
  float widest = 0.0f;
  int pulled = 0;
  if (!t->pulls) return 1;
  for (size_t k = 0; k < t->count; k++) {
    widest = fmaxf(widest, t->samples[k].opening);
    pulled |= t->samples[k].pull != 0.0f;
  }
  errno = EINVAL;
  if (widest <= 0.0f || !pulled) return 1;
  memset(sum, 0, sizeof sum);
  memset(count, 0, sizeof count);
  for (size_t k = 0; k < t->count; k++) {
    const size_t column = (size_t)((double)t->samples[k].opening / (double)widest * (COLUMNS - 1));
    /* what rests at the end of its path says nothing of the way there */
    if (k > 0 && t->samples[k].opening == t->samples[k - 1].opening) continue;
    sum[column] += (double)t->samples[k].pull;
    count[column] += 1.0;
  }
  for (size_t n = 0; n < COLUMNS; n++) sum[n] = count[n] > 0.0 ? sum[n] / count[n] : n > 0 ? sum[n - 1] : 0.0;
  canvas c;
  errno = ENOMEM;
  if (!canvas_open(&c, WIDTH, 2 * PANEL, SAMPLES)) return 0;
  canvas_fill(&c, rgb_hex(0xFFFFFF), rgb_hex(0xFFFFFF));
  plot p = {.title = "force over opening",
            .x_label = "opening, cm",
            .y_label = "N",
            .x_first = 0.0,
            .x_step = (double)widest / (COLUMNS - 1),
            .points = COLUMNS,
            .series_count = 1,
            .y_from_zero = 1};
  p.series[0] = (plot_series){"pull", sum, plot_colour(0)};
  plot_draw(&c, (plot_area){0, 0, WIDTH, 2 * PANEL}, &p);
  const int good = canvas_write(&c, path);
  canvas_close(&c);
  return good;
}
