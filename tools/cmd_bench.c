/* SPDX-License-Identifier: Apache-2.0 */
/* fray bench: time per projection beside float loops of the same links in the same run, and time
 * and counted work per tick by stage. Ratios are what counts; times are this machine's. */
#include "tools/cmd_bench.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rt/stage/stage.h"
#include "tools/bench/float_loop.h"
#include "tools/bench/timed_tick.h"
#include "tools/build/build.h"
#include "tools/options.h"
#include "tools/session.h"

enum { ROUNDS = 15, SWEEPS = 20, SHEET_TICKS = 200, TICKS_MAX = 100000 };

typedef struct {
  double fixed_ns, plain_ns, coloured_ns; /* per projection, least of ROUNDS */
} projection_times;

typedef struct {
  uint32_t ticks, rate_hz, substeps;
  double total_ns;
  double stage_ns[TIMED_COUNT];
  uint32_t work_median, work_worst; /* counted: sum of all kinds */
  uint32_t projections;             /* of the worst tick */
} tick_times;

static void print_usage(FILE *out) {
  fprintf(out,
          "usage: fray bench [X.scene|X.img [--log IN.log [--key FILE]]] [--ticks N] [--json]\n\n"
          "Without a scene: hanging sheets of 41x41, 64x64, 80x40 and 160x80, 4 substeps; per\n"
          "projection next to a plain and a coloured scalar float loop of the same links.\n"
          "With one: time and counted work per tick, by stage. --key: of a recording under a key.\n\n"
          "exit: 0 good, 1 out of memory, 2 wrong use or unreadable input\n");
}

static double least(double a, double b) { return a < b ? a : b; }

static double time_fixed(fray_world *w) {
  w->work.projections = 0;
  const double before = timed_now_ns();
  for (int n = 0; n < SWEEPS; ++n) strain_run(w);
  return (timed_now_ns() - before) / w->work.projections;
}

static double time_float(float_loop *f) {
  const double before = timed_now_ns();
  for (int n = 0; n < SWEEPS; ++n) float_loop_sweep(f);
  return (timed_now_ns() - before) / ((double)SWEEPS * f->rows);
}

/* The three loops in turn, so that a change of the machine's speed meets all of them. */
static int time_projections(fray_world *w, projection_times *t) {
  float_loop plain;
  float_loop coloured;
  const int opened = float_loop_open(&plain, w, FLOAT_PLAIN);
  const int good = float_loop_open(&coloured, w, FLOAT_COLOURED) && opened;
  *t = (projection_times){1e9, 1e9, 1e9};
  for (int round = 0; good && round < ROUNDS; ++round) {
    t->fixed_ns = least(t->fixed_ns, time_fixed(w));
    t->plain_ns = least(t->plain_ns, time_float(&plain));
    t->coloured_ns = least(t->coloured_ns, time_float(&coloured));
  }
  float_loop_close(&plain);
  float_loop_close(&coloured);
  return good;
}

static uint32_t counted(const fray_work *k) {
  return k->predictions + k->projections + k->springs + k->contacts + k->tear_tests + k->cuts;
}

static int by_size(const void *a, const void *b) {
  const uint32_t x = *(const uint32_t *)a;
  const uint32_t y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

/* Runs a session; its world is stepped on. */
static int time_ticks(session *s, uint32_t ticks, tick_times *t) {
  uint32_t *work = malloc(ticks * sizeof *work);
  fray_output out;
  if (work == NULL) return 0;
  memset(t, 0, sizeof *t);
  memset(timed_ns, 0, sizeof timed_ns);
  const double before = timed_now_ns();
  for (uint32_t n = 0; n < ticks; ++n) {
    timed_tick(s->opened.world, session_input(s, n), &out);
    work[n] = counted(&out.work);
    if (out.work.projections > t->projections) t->projections = out.work.projections;
  }
  t->total_ns = timed_now_ns() - before;
  qsort(work, ticks, sizeof *work, by_size);
  t->ticks = ticks;
  t->rate_hz = s->facts.rate_hz;
  t->substeps = s->facts.substeps;
  t->work_median = work[ticks / 2];
  t->work_worst = work[ticks - 1];
  memcpy(t->stage_ns, timed_ns, sizeof t->stage_ns);
  free(work);
  return 1;
}

static void print_ticks(const tick_times *t) {
  const double tick_ns = t->total_ns / t->ticks;
  printf("  %u ticks at %u Hz, %u substeps: %.1f us a tick, %.2f times real time\n", t->ticks,
         t->rate_hz, t->substeps, tick_ns / 1e3, 1e9 / t->rate_hz / tick_ns);
  printf("  counted work a tick: median %u, worst %u\n", t->work_median, t->work_worst);
  for (int n = 0; n < TIMED_COUNT; ++n)
    printf("    %-16s %9.2f us  %5.1f %%\n", timed_labels[n], t->stage_ns[n] / t->ticks / 1e3,
           100.0 * t->stage_ns[n] / t->total_ns);
}

static void print_ticks_json(const tick_times *t) {
  printf("\"ticks\": %u, \"tick_us\": %.3f, \"real_time\": %.3f, \"work_median\": %u, "
         "\"work_worst\": %u, \"stage_us\": {",
         t->ticks, t->total_ns / t->ticks / 1e3, 1e9 / t->rate_hz / (t->total_ns / t->ticks),
         t->work_median, t->work_worst);
  for (int n = 0; n < TIMED_COUNT; ++n)
    printf("%s\"%s\": %.3f", n > 0 ? ", " : "", timed_labels[n], t->stage_ns[n] / t->ticks / 1e3);
  printf("}");
}

/* A sheet that hangs from its top row. */
static int open_sheet(uint32_t warps, uint32_t wefts, session *s) {
  char text[512];
  char name[32];
  scene_error error;
  build_report report;
  snprintf(name, sizeof name, "%ux%u", warps, wefts);
  const int bytes = snprintf(text, sizeof text,
                             "scene bench\nrate 1000 Hz\nsubsteps 4\nsweeps 1\n"
                             "sheet {\n warps %u\n wefts %u\n spacing 12 /cm\n gather 5 %%\n"
                             " tear off\n}\npin row top\n",
                             warps, wefts);
  memset(s, 0, sizeof *s);
  scene *parsed = malloc(sizeof *parsed);
  const int good = parsed != NULL && scene_parse(name, text, (size_t)bytes, parsed, &error) &&
                   build_image(parsed, name, &s->opened.image, &s->opened.image_bytes, &report,
                               NULL, NULL, &error) &&
                   world_open_image(name, &s->opened, stderr) == 0;
  free(parsed);
  if (good) s->facts = fray_describe(s->opened.world);
  return good;
}

static int bench_sheet(uint32_t warps, uint32_t wefts, int json, int first) {
  session s;
  projection_times p;
  tick_times t;
  if (!open_sheet(warps, wefts, &s)) return 0;
  const int good = time_ticks(&s, SHEET_TICKS, &t) && time_projections(s.opened.world, &p);
  if (good && json) {
    printf("%s{\"sheet\": \"%ux%u\", \"projection_ns\": %.3f, \"float_plain_ns\": %.3f, "
           "\"float_coloured_ns\": %.3f, \"ratio\": %.3f, ",
           first ? "[" : ",\n ", warps, wefts, p.fixed_ns, p.plain_ns, p.coloured_ns,
           p.fixed_ns / p.coloured_ns);
    print_ticks_json(&t);
    printf("}");
  } else if (good) {
    printf("%ux%u hanging\n  projection: %.2f ns; float plain %.2f ns, coloured %.2f ns; "
           "ratio to coloured %.2f\n",
           warps, wefts, p.fixed_ns, p.plain_ns, p.coloured_ns, p.fixed_ns / p.coloured_ns);
    print_ticks(&t);
  }
  session_close(&s);
  return good;
}

static int bench_sheets(int json) {
  static const uint32_t sizes[4][2] = {{41, 41}, {64, 64}, {80, 40}, {160, 80}};
  for (int n = 0; n < 4; ++n)
    if (!bench_sheet(sizes[n][0], sizes[n][1], json, n == 0)) return 1;
  if (json) printf("]\n");
  return 0;
}

static int bench_scene(const char *file, const char *log, const char *key, uint32_t ticks,
                       int json) {
  session s;
  tick_times t;
  if (session_open(&s, file, log, key, 0) != 0) return 2;
  if (ticks == 0) ticks = log != NULL ? s.log.count : 1000;
  const int good = ticks > 0 && time_ticks(&s, ticks, &t);
  if (good && json) {
    printf("{\"scene\": \"%s\", ", file);
    print_ticks_json(&t);
    printf("}\n");
  } else if (good) {
    printf("%s\n", file);
    print_ticks(&t);
  }
  session_close(&s);
  return good ? 0 : 1;
}

int cmd_bench(int argc, char **argv) {
  const char *file = NULL;
  const char *log = NULL;
  const char *key = NULL;
  uint32_t ticks = 0;
  int json = 0;
  const option table[] = {{"--log", &log, NULL, NULL, 0, 0},
                          {"--ticks", NULL, &ticks, NULL, 1, TICKS_MAX},
                          {"--key", &key, NULL, NULL, 0, 0},
                          {"--json", NULL, NULL, &json, 0, 0}};
  const options_result wish =
      options_parse(argc, argv, table, sizeof table / sizeof table[0], &file);
  if (wish == OPTIONS_HELP || (log != NULL && file == NULL)) {
    print_usage(wish == OPTIONS_HELP ? stdout : stderr);
    return wish == OPTIONS_HELP ? 0 : 2;
  }
  if (wish == OPTIONS_WRONG) return 2;
  if (key != NULL && log == NULL) {
    fprintf(stderr, "fray bench: --key goes with --log\n");
    return 2;
  }
  return file != NULL ? bench_scene(file, log, key, ticks, json) : bench_sheets(json);
}
