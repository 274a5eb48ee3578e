/* SPDX-License-Identifier: Apache-2.0 */
/* fray bench: times and counted work of ticks by stage, and time per projection beside float loops
 * over the same links in the same run. Compare ratios; times depend on the machine. */
#include "tools/cmd/cmd.h"

#include <stdio.h>
#include <string.h>

#include "platform/files/output_file.h"
#include "tools/bench/result.h"
#include "tools/bench/worker_ticks.h"
#include "tools/bench/woven_sample.h"
#include "tools/bench/yarn_times.h"
#include "tools/terminal/options.h"

enum { SHEET_TICKS = 200, SCENE_TICKS = 1000, TICKS_MAX = 100000, RUN_ROWS_MIN = 1000,
       SHARED_TICKS = 300 };

typedef struct {
  const char *scene, *log, *key, *kernel, *json_file, *rows_file;
  uint32_t ticks, workers;
  int cut, sweep, yarns, machine;
} wishes;

typedef struct {
  output_file json_file, rows_file; /* without a stream: not requested */
  json j;
} sinks;

static void print_usage(FILE *out) {
  fprintf(out,
          "usage: fray bench [X.scene|X.img [--log IN.log [--key FILE]]] [options]\n\n"
          "Time per projection beside float loops over the same links, from the same positions:\n"
          "sequential, coloured, and eight at a time with AVX2, gathered and contiguous.\n"
          "Time and counted work per tick, by stage. Each kernel that this machine has.\n"
          "Without a scene: woven cloth of 41x41 to 320x160 that hangs from its top, 4 substeps.\n\n"
          "  --log IN.log     the scene's inputs; --key FILE: the key of an authenticated log\n"
          "  --cut            the log was cut off: takes what of it is whole\n"
          "  --machine        prints processor and compiler\n"
          "  --sweep          instead: time per tick against crossings, 1k to 250k\n"
          "  --yarns          instead: torn cloth of 120x60, two-level model beside all yarn;\n"
          "                   with --sweep: torn cloth of 1k to 40k crossings\n"
          "  --ticks N        how many (default: the log's, or 1000; without a scene 200)\n"
          "  --workers N      also ticks on N threads, beside those on one (default 2)\n"
          "  --kernel NAME    scalar, avx2, avx512, neon (default: all; --sweep: the fastest)\n"
          "  --json FILE      everything, as JSON\n"
          "  --rows FILE      rows for the tables of `make bench`, added to FILE\n\n"
          "exit: 0 good, 1 out of memory, cannot write, or kernels differ; 2 wrong use or\n"
          "unreadable input\n");
}

/* ---- results ---- */

static int fail(const char *path) {
  fprintf(stderr, "%s: cannot be written: %s\n", path, output_file_reason());
  return 0;
}

static int open_one(const char *path, output_file *out) {
  return path == NULL || output_file_open(out, path) || fail(path);
}

/* The rows that the file has so far. */
static int open_rows(const char *path, output_file *out) {
  FILE *old = path != NULL ? fopen(path, "rb") : NULL;
  int good = open_one(path, out);
  for (int c = old != NULL && good && out->aside >= 0 ? fgetc(old) : EOF; c != EOF; c = fgetc(old)) fputc(c, out->stream);
  if (old != NULL && ferror(old)) good = fail(path);
  if (old != NULL) fclose(old);
  return good;
}

static int open_sinks(const wishes *wish, sinks *s) {
  memset(s, 0, sizeof *s);
  s->json_file.aside = s->rows_file.aside = -1;
  if (!open_one(wish->json_file, &s->json_file)) return 0;
  if (!open_rows(wish->rows_file, &s->rows_file)) {
    output_file_drop(&s->json_file);
    output_file_drop(&s->rows_file);
    return 0;
  }
  if (s->json_file.stream == NULL) return 1;
  s->j.out = s->json_file.stream;
  json_begin(&s->j, NULL, '{');
  machine_json(&s->j);
  return 1;
}

static int close_one(output_file *out, const char *path, int keep) {
  if (!keep) output_file_drop(out);
  return out->stream == NULL || output_file_keep(out) || fail(path);
}

/* What a failed bench wrote is not kept. */
static int close_sinks(const wishes *wish, sinks *s, int keep) {
  if (s->json_file.stream != NULL) json_end(&s->j, '}');
  const int good = close_one(&s->json_file, wish->json_file, keep);
  return close_one(&s->rows_file, wish->rows_file, keep) && good;
}

static void put_result(sinks *s, const bench_result *r) {
  result_print(stdout, r);
  fflush(stdout);
  if (s->json_file.stream != NULL) result_json(&s->j, r);
  if (s->rows_file.stream != NULL) result_table(s->rows_file.stream, r);
}

/* ---- scenes ---- */

static int kernels_agree(const bench_result *r) {
  for (uint32_t n = 1; n < r->kernels.count; ++n)
    if (r->profiles[n].hash != r->profiles[0].hash) {
      fprintf(stderr, "%s: kernels differ after tick %u\n", r->name, r->profiles[n].ticks - 1);
      return 0;
    }
  return 1;
}

/* A world of its own, so that the session's stays unchanged. */
static int time_projections(const session *s, const kernels *k, projection_times *t, int runs) {
  struct world_file o;
  if (!kernels_reopen_world(&s->world_file, &o)) return 0;
  const int enough = fray_get_info(o.world).springs[FRAY_STRUCTURAL] != 0 &&
                     (!runs || projections_keep_runs(&o) >= RUN_ROWS_MIN);
  const int good = !enough || projections_time(o.world, k, t);
  world_file_close(&o);
  return good;
}

static int bench_session(const char *name, const session *s, const wishes *wish, uint32_t ticks,
                         sinks *to) {
  bench_result r;
  memset(&r, 0, sizeof r);
  r.name = name;
  r.warps = fray_view_weave(s->world_file.world).warps;
  r.wefts = fray_view_weave(s->world_file.world).wefts;
  r.triangles = fray_get_info(s->world_file.world).triangles;
  r.memory_bytes = s->world_file.memory_bytes;
  if (!kernels_find(&r.kernels, s->world_file.world, wish->kernel)) return 2;
  const int good = profiles_take(s, &r.kernels, ticks, r.profiles) &&
                   time_projections(s, &r.kernels, &r.any, 0) &&
                   time_projections(s, &r.kernels, &r.runs, 1);
  if (!good) {
    fprintf(stderr, "%s: not enough memory\n", name);
    return 1;
  }
  put_result(to, &r);
  worker_times shared;
  if (!worker_ticks_time(s, ticks < SHARED_TICKS ? ticks : SHARED_TICKS, wish->workers, &shared))
    return 1;
  worker_ticks_print(stdout, &shared);
  return kernels_agree(&r) ? 0 : 1;
}

static int bench_scene(const wishes *wish, sinks *to) {
  session s;
  int code = session_open(&s, wish->scene, &(session_log){.file = wish->log, .key = wish->key, .cut = wish->cut}, 0);
  if (code != 0) return code;
  machine_print(stdout);
  uint32_t ticks = wish->log != NULL ? s.log.count : SCENE_TICKS;
  if (wish->ticks != 0) ticks = wish->ticks;
  code = bench_session(wish->scene, &s, wish, ticks, to);
  session_close(&s);
  return code;
}

static int bench_woven_samples(const wishes *wish, sinks *to) {
  static const uint32_t sizes[5][2] = {{41, 41}, {64, 64}, {80, 40}, {160, 80}, {320, 160}};
  int code = 0;
  machine_print(stdout);
  for (int n = 0; code == 0 && n < 5; ++n) {
    session s;
    char name[32];
    snprintf(name, sizeof name, "cloth %ux%u", sizes[n][0], sizes[n][1]);
    if (!woven_sample_open(sizes[n][0], sizes[n][1], &s)) return 1;
    code = bench_session(name, &s, wish, wish->ticks != 0 ? wish->ticks : SHEET_TICKS, to);
    session_close(&s);
  }
  return code;
}

static int bench_scaling(const wishes *wish, sinks *to) {
  scaling g;
  const int code = scaling_measure(wish->kernel, &g);
  if (code != 0) return code;
  scaling_print(stdout, &g);
  if (to->json_file.stream != NULL) scaling_json(&to->j, &g);
  if (to->rows_file.stream != NULL) scaling_table(to->rows_file.stream, &g);
  return 0;
}

static int bench_yarns(const wishes *wish) {
  yarn_scaling g;
  yarn_levels l;
  const int code =
      wish->sweep ? yarn_scaling_measure(wish->kernel, &g) : yarn_levels_measure(wish->kernel, &l);
  if (code == 0 && wish->sweep) yarn_scaling_print(stdout, &g);
  if (code == 0 && !wish->sweep) yarn_levels_print(stdout, &l);
  return code;
}

static int bench(const wishes *wish) {
  sinks to;
  int code;
  if (!open_sinks(wish, &to)) return 1;
  if (wish->yarns || wish->sweep) machine_print(stdout);
  if (wish->yarns) {
    code = bench_yarns(wish);
  } else if (wish->sweep) {
    code = bench_scaling(wish, &to);
  } else {
    if (to.json_file.stream != NULL) json_begin(&to.j, "scenes", '[');
    code = wish->scene != NULL ? bench_scene(wish, &to) : bench_woven_samples(wish, &to);
    if (to.json_file.stream != NULL) json_end(&to.j, ']');
  }
  return close_sinks(wish, &to, code == 0) || code != 0 ? code : 1;
}

/* A wrong combination of options; NULL: none. */
static const char *contradiction(const wishes *wish) {
  if (wish->key != NULL && wish->log == NULL) return "--key goes with --log";
  if (wish->cut && wish->log == NULL) return "--cut goes with --log";
  if (wish->log != NULL && wish->scene == NULL) return "--log goes with a scene";
  if (wish->machine && (wish->sweep || wish->scene != NULL))
    return "--machine says only what the machine is, expected no scene and no --sweep";
  if (wish->yarns && (wish->scene != NULL || wish->ticks != 0 || wish->machine ||
                      wish->json_file != NULL || wish->rows_file != NULL))
    return "--yarns makes its own cloth and prints, expected no scene, --ticks, --json or --rows";
  if (wish->sweep && (wish->scene != NULL || wish->ticks != 0))
    return "--sweep makes its own cloth, expected no scene and no --ticks";
  return NULL;
}

int cmd_bench(int argc, char **argv) {
  wishes wish;
  memset(&wish, 0, sizeof wish);
  wish.workers = 2;
  const option table[] = {{"--log", &wish.log, NULL, NULL, OPTION_INPUT, 0},
                          {"--key", &wish.key, NULL, NULL, OPTION_INPUT, 0},
                          {"--cut", NULL, NULL, &wish.cut, 0, 0},
                          {"--machine", NULL, NULL, &wish.machine, 0, 0},
                          {"--sweep", NULL, NULL, &wish.sweep, 0, 0},
                          {"--yarns", NULL, NULL, &wish.yarns, 0, 0},
                          {"--ticks", NULL, &wish.ticks, NULL, 1, TICKS_MAX},
                          {"--workers", NULL, &wish.workers, NULL, 1, 16},
                          {"--kernel", &wish.kernel, NULL, NULL, 0, 0},
                          {"--json", &wish.json_file, NULL, NULL, OPTION_OUTPUT, 0},
                          {"--rows", &wish.rows_file, NULL, NULL, OPTION_OUTPUT, 0}};
  const options_result found =
      options_parse(argc, argv, table, sizeof table / sizeof table[0], &wish.scene);
  if (found == OPTIONS_HELP) {
    print_usage(stdout);
    return 0;
  }
  const char *wrong = found == OPTIONS_GOOD ? contradiction(&wish) : NULL;
  if (wrong != NULL) fprintf(stderr, "fray bench: %s\n", wrong);
  if (found != OPTIONS_GOOD || wrong != NULL) return 2;
  if (!wish.machine) return bench(&wish);
  machine_print(stdout);
  return 0;
}
