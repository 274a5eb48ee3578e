/* SPDX-License-Identifier: Apache-2.0 */
/* fray run: steps a world through a log, records the bus, and reports. */
#include "tools/cmd/cmd.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/files/output_file.h"
#include "tools/world/world_workers.h"
#include "tools/world/kernel.h"
#include "tools/bus/live.h"
#include "tools/analysis/fraying.h"
#include "tools/terminal/options.h"
#include "tools/analysis/components.h"
#include "tools/analysis/energy_table.h"
#include "tools/analysis/scaled_stiffness.h"
#include "tools/analysis/fault_text.h"
#include "tools/analysis/tear_force.h"
#include "tools/terminal/progress.h"
#include "tools/terminal/signals.h"
#include "tools/recording/record.h"
#include "tools/render/album.h"
#include "tools/render/run_trace.h"
#include "tools/recording/session.h"
#include "tools/analysis/work_tally.h"

enum { DEFAULT_TICKS = 1000, PICTURES = 8, PATH_ROOM = 1024, PRIORITY = 80, COMPONENTS = 8 };

typedef struct {
  const char *file, *log, *record, *report, *save, *energy, *can;
  uint32_t ticks, instance, priority, cpu, workers;
  int realtime, cut;
  const char *kernel;
  bus_key_options key;
} run_options;

typedef struct {
  const run_options *o;
  session s;
  world_workers world_workers;
  uint64_t ticks;      /* to run; after a signal: that ran */
  int signal;          /* that ended the run, 0: none */
  output_file out;     /* the recording; without a stream: none */
  record recording;
  output_file energy;  /* without a stream: none */
  run_trace trace;
  work_tally tally;
  album pictures;
  fray_output last;
  uint64_t first_tear;  /* tick, or UINT64_MAX */
  uint16_t faults;     /* of all ticks */
  live_start start;    /* DONE too where the image is of a running session */
} run_job;

static void print_usage(FILE *out) {
  fprintf(out,
          "usage: fray run X.scene|X.img [--log IN.log | --can IFACE] [options]\n\n"
          "Steps a world. Its inputs are the POSE and COMMAND frames of a log: a device log, by\n"
          "their times, or a recording, by its SYNCs.\n\n"
          "  --log FILE       inputs (candump -L); without it nothing moves the hands\n"
          "  --cut            the log was cut off: takes what of it is whole\n"
          "  --ticks N        how many ticks (default: the log's, or %d)\n"
          "  --record FILE    writes the bus as a candump log that `fray verify` accepts\n"
          "  --report DIR     pictures, plots of forces, of two hands at a tear, and of work,\n"
          "                   summary.txt\n"
          "  --save FILE      writes the last state as an image\n"
          "  --energy FILE    watches the energy: a CSV, in joules, with a line a tick of what is stored,\n"
          "                   supplied, made and lost (rt/energy/README.md), and at the end a short\n"
          "                   account and the fastest particle; ticks take several times as long\n"
          "  --kernel NAME    scalar, avx2, avx512, neon: the same hashes, other speeds (default:\n"
          "                   the fastest that this machine has)\n"
          "  --instance N     which runtime on the bus, 0 to 7 (default 0)\n"
          "  --can IFACE      runs on a SocketCAN interface until --ticks or a signal, sends STOP and\n"
          "                   lets forces fade; --record then logs everything that passes on the bus,\n"
          "                   under its name from the first tick on\n"
          "  --realtime       SCHED_FIFO (--priority N, default 80) and locked memory\n"
          "  --cpu N          pins the process to this CPU, workers to the next ones\n"
          "  --workers N      threads that share a tick (default 1; 0: as many as are useful); the\n"
          "                   same hashes for any number\n"
          "  --key FILE       with --can: POSE, COMMAND, FORCE and ACK carry a tag under this key, on\n"
          "                   CAN FD; with --log: the key of such a recording. 32 hex digits,\n"
          "                   mode 0600\n"
          "  --classic-tags   with --key on classic CAN: expects a TAG after every fourth POSE;\n"
          "                   three bad ones in a row lead to SAFE until RESET\n"
          "  --freshness FILE the counters of this end, so that one key lasts for many sessions;\n"
          "                   each end has its own file\n\n"
          "The last line is `hash <16 hex> ticks <n> tears <n> pieces <n> faults <n>`.\n\n"
          "Ctrl-C (SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGALRM, SIGUSR1, SIGUSR2, SIGXCPU) ends a run after\n"
          "a whole tick: recording, image and report are those so far. While the report is written,\n"
          "it ends after a whole picture.\n\n"
          "exit: 0 good, 1 the run failed, 2 wrong use or unreadable input; without --can 128 and the\n"
          "signal's number where one ended the run\n",
          DEFAULT_TICKS);
}

static int fail(const char *path) {
  fprintf(stderr, "%s: cannot be written: %s\n", path, output_file_reason());
  return 0;
}

static int begin(run_job *j) {
  const fray_info *f = &j->s.facts;
  j->ticks = j->o->ticks != 0 ? j->o->ticks : (j->o->log != NULL ? j->s.log.count : DEFAULT_TICKS);
  j->first_tear = UINT64_MAX;
  run_trace_open(&j->trace, f->rate_hz, f->hands);
  run_trace_start(&j->trace, j->s.world_file.world);
  work_tally_open(&j->tally, j->s.world_file.world);
  album_open(&j->pictures);
  if (j->o->record != NULL) {
    if (!output_file_open(&j->out, j->o->record)) return fail(j->o->record);
    record_begin(&j->recording, j->out.stream, j->o->instance, f->hands, f->rate_hz, f->tick,
                 fray_hash(j->s.world_file.world));
    j->recording.sender.contacts_max = fray_work_bound(j->s.world_file.world).contacts;
  }
  if (j->o->energy != NULL) {
    if (!output_file_open(&j->energy, j->o->energy)) return fail(j->o->energy);
    fray_energy_watch(j->s.world_file.world);
    energy_table_head(j->energy.stream);
  }
  return 1;
}

static void write_energy(run_job *j) {
  const fray_energy_account account = fray_energy(j->s.world_file.world);
  energy_table_line(j->energy.stream, &j->s.facts, j->last.tick, &account);
}

/* Pictures at even intervals, and one at the first tear. */
static int take_picture(run_job *j, uint64_t n, int tore_first) {
  const uint64_t step = j->ticks / (PICTURES - 1) > 0 ? j->ticks / (PICTURES - 1) : 1;
  if (j->o->report == NULL || (n % step != 0 && n != j->ticks && !tore_first)) return 1;
  if (n + step > j->ticks && n != j->ticks && !tore_first) return 1;
  if (album_add(&j->pictures, j->s.world_file.world)) return 1;
  fprintf(stderr, "fray run: not enough memory for pictures\n");
  return 0;
}

/* Of a run that a signal ended between two pictures. */
static int take_last_picture(run_job *j) {
  const uint64_t tick = fray_get_info(j->s.world_file.world).tick;
  const size_t count = j->pictures.count;
  if (j->o->report == NULL || (count > 0 && j->pictures.pictures[count - 1].tick == tick)) return 1;
  return take_picture(j, j->ticks, 1);
}

static int step(run_job *j, uint64_t n) {
  const fray_input *input = session_input(&j->s, n);
  workers_tick(&j->world_workers.group, input, &j->last);
  j->faults |= j->last.faults;
  j->start = live_start_seen(j->start, &j->last);
  work_tally_add(&j->tally, &j->last);
  const int tore_first = j->first_tear == UINT64_MAX && j->last.work.tears != 0;
  if (tore_first) j->first_tear = j->last.tick;
  if (j->energy.stream != NULL) write_energy(j);
  if (j->o->report != NULL) run_trace_add(&j->trace, &j->last, j->s.world_file.world);
  if (j->out.stream != NULL && !record_tick(&j->recording, input, &j->last)) return fail(j->o->record);
  return take_picture(j, n + 1, tore_first);
}

/* The one place where a recorded session ends. */
static int end_recording(run_job *j) {
  if (j->out.stream == NULL) return 1;
  return (record_end(&j->recording) && output_file_keep(&j->out)) || fail(j->o->record);
}

/* A signal ends it after a whole tick. */
static int run(run_job *j) {
  char what[64];
  signals_note(SIGNALS_FIRST, NULL);
  if (!take_picture(j, 0, 0)) return 0;
  for (uint64_t n = 0; n < j->ticks; ++n) {
    if (!step(j, n)) return 0;
    j->signal = signals_seen();
    if (j->signal != 0) j->ticks = n + 1;
    snprintf(what, sizeof what, "run: %u tears", j->last.tears_total);
    progress_show(what, n + 1, j->ticks);
  }
  progress_end();
  if (j->energy.stream != NULL && !output_file_keep(&j->energy)) return fail(j->o->energy);
  if (j->signal != 0 && !take_last_picture(j)) return 0;
  return end_recording(j);
}

static int run_with_workers(run_job *j) {
  if (!world_workers_open(&j->world_workers, j->s.world_file.world, j->o->workers, WORKERS_ANY_CPU)) return 0;
  const int good = run(j);
  world_workers_close(&j->world_workers);
  return good;
}

static int save(const run_job *j) {
  const size_t bytes = fray_save_bytes(j->s.world_file.world);
  void *image = malloc(bytes);
  const int good = image != NULL && fray_save(j->s.world_file.world, image, bytes) == bytes &&
                   output_file_write(j->o->save, image, bytes);
  free(image);
  return good || fail(j->o->save);
}

/* Its number in the order of the scene, and what it is: images hold no names. */
static void print_body(const run_job *j, FILE *out, uint32_t b) {
  static const char *const motions[] = {"fixed", "on a path", "hand", "free"};
  const fray_body v = fray_view_body(j->s.world_file.world, b);
  if (v.motion == FRAY_HAND)
    fprintf(out, " %u (%s hand)", b, v.hand == 0 ? "left" : "right");
  else
    fprintf(out, " %u (%s)", b, motions[v.motion]);
}

static void print_components(const run_job *j, FILE *out, const component *components, uint32_t count) {
  const char *of = j->s.facts.triangles_max != 0 ? "vertices"
                   : j->s.facts.splits_max != 0  ? "particles"
                                                 : "crossings";
  fprintf(out, "pieces       %u\n", count);
  const uint32_t shown = count < COMPONENTS ? count : COMPONENTS;
  for (uint32_t n = 0; n < shown; ++n) {
    fprintf(out, "             %u %s, %s", components[n].crossings, of,
            components[n].holders == 0 ? "free" : "attached to body");
    for (uint32_t b = 0; b < j->s.facts.bodies; ++b)
      if ((components[n].holders >> b & 1u) != 0) print_body(j, out, b);
    fprintf(out, "\n");
  }
  if (count > shown) fprintf(out, "             and %u smaller ones\n", count - shown);
}

static void print_yarns(const run_job *j, FILE *out) {
  fraying e;
  if ((j->last.tears_total == 0 && j->s.facts.splits_max == 0) || j->s.facts.triangles_max != 0) return;
  if (!fraying_measure(j->s.world_file.world, &e)) return;
  if (j->s.facts.splits_max != 0) {
    fprintf(out, "yarns        %u crossings split: %u connected, %u loose, %u disconnected\n", e.split,
            e.connected, e.loose, e.disconnected);
  }
  fprintf(out,
          "fray         %.3f cm of loose ends per cm of tear: %u ends, %.2f cm on %.2f cm; weave open "
          "%.3f cm wide\n",
          e.fray, e.ends, e.loose_cm, e.tear_cm, e.zone_cm);
}

/* The state at the end, of worlds with hands. */
static void print_state(const run_job *j, FILE *out) {
  static const char *const names[] = {"none", "ready", "operational", "safe"};
  static const char *const why[] = {
      ": the hands never started, no START was accepted; all forces are zero",
      ": the hands never started: after START not every hand sent 16 good poses in a row; all forces are zero",
      ""};
  if (j->s.facts.hands == 0) return;
  fprintf(out, "state        %s%s\n", names[j->last.state & 3], why[j->start]);
}

/* What the devices at handles were given since START; below 0 they gave. */
static void print_handles(const run_job *j, FILE *out) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    fray_handle v;
    if (fray_view_handle(j->s.world_file.world, h, &v) == 0) continue;
    fprintf(out, "device       %s was given %.3f mJ since START, %.3f at most; the controller took %.3f mJ\n",
            h == 0 ? "left" : "right", (double)v.given_nj * 1e-6, (double)v.given_most_nj * 1e-6,
            (double)v.taken_nj * 1e-6);
  }
}

/* Of two hands in a run with a report. Returns 0 where there are no phases of a tear to be seen. */
static int find_tear_force(const run_job *j, tear_force *f) {
  const size_t count = j->s.facts.hands == 3u ? j->trace.count : 0;
  tear_force_sample *samples = count != 0 ? malloc(count * sizeof *samples) : NULL;
  if (samples == NULL) return 0;
  for (size_t n = 0; n < count; ++n) {
    const run_sample *s = &j->trace.samples[n];
    memcpy(samples[n].force, s->force, sizeof s->force);
    samples[n].apart = s->apart;
    samples[n].tears = s->work.tears;
  }
  const int found = tear_force_measure(samples, count, f);
  free(samples);
  return found;
}

/* Counts of accepted and refused frames of a device log. */
static void print_input(const replay *log, FILE *out) {
  const port_statistics *p = &log->port;
  const uint32_t unknown = p->unknown_id - log->absent[0] - log->absent[1];
  fprintf(out, "input        %u frames accepted", p->accepted);
  if (p->lost != 0) fprintf(out, ", %u lost", p->lost);
  if (p->repeated != 0) fprintf(out, ", %u repeated", p->repeated);
  if (p->old != 0) fprintf(out, ", %u too late", p->old);
  if (p->wrong_crc != 0) fprintf(out, ", %u with a wrong CRC", p->wrong_crc);
  if (p->wrong_length + p->wrong_flags + p->wrong_field != 0)
    fprintf(out, ", %u of a wrong form", p->wrong_length + p->wrong_flags + p->wrong_field);
  if (unknown != 0) fprintf(out, ", %u with an unknown id", unknown);
  if (p->queue_full != 0) fprintf(out, ", %u dropped", p->queue_full);
  fprintf(out, "\n");
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    if (log->absent[h] != 0)
      fprintf(out, "hand %-7s not in this world: its %u poses move nothing\n", h == 0 ? "left" : "right", log->absent[h]);
}

static void print_summary(run_job *j, FILE *out, const component *components, uint32_t count) {
  const fray_info *f = &j->s.facts;
  const fray_work max = fray_work_bound(j->s.world_file.world);
  char scaled[SCALED_STIFFNESS_TEXT];
  fprintf(out, "scene        %s\n", j->o->file);
  fprintf(out, "rate         %u Hz, %u substeps, %u iterations\n", f->rate_hz, f->substeps, f->iterations);
  if (scaled_stiffness_text(f, scaled)) fprintf(out, "stiffness    %s\n", scaled);
  fprintf(out, "ticks        %" PRIu64 " (%.3f s)\n", j->ticks, (double)j->ticks / f->rate_hz);
  if (j->o->log != NULL && !j->s.log.recording) print_input(&j->s.log, out);
  if (j->first_tear != UINT64_MAX)
    fprintf(out, "first tear   tick %" PRIu64 " (%.3f s)\n", j->first_tear,
            (double)j->first_tear / f->rate_hz);
  if (f->triangles_max != 0)
    fprintf(out, "tears        %u, triangles %u of %u\n", j->last.tears_total,
            fray_get_info(j->s.world_file.world).triangles, f->triangles_max);
  else
    fprintf(out, "breaks       %u of %u springs\n", j->last.tears_total, f->springs[FRAY_STRUCTURAL]);
  if (j->signal != 0) fprintf(out, "ended        by signal %d, before all ticks were run\n", j->signal);
  tear_force force;
  print_state(j, out);
  print_handles(j, out);
  if (find_tear_force(j, &force)) tear_force_print(out, &force, f->rate_hz);
  print_components(j, out, components, count);
  print_yarns(j, out);
  fault_text_print(out, j->faults);
  if (j->o->energy != NULL) {
    const fray_energy_account account = fray_energy(j->s.world_file.world);
    energy_table_print(out, f, &account);
  }
  if (f->triangles_max != 0)
    fprintf(out, "work bound   %u element forces, %u bend forces, %u particle steps, %u contact tests a tick\n",
            max.element_forces, max.bend_forces, max.particle_steps, max.contacts);
  else
    fprintf(out, "work bound   %u projections, %u particle steps, %u contact tests a tick\n", max.projections,
            max.particle_steps, max.contacts);
  if (f->triangles_max == 0) work_tally_print(&j->tally, out);
}

static int write_summary(run_job *j, const component *components, uint32_t count) {
  char path[PATH_ROOM];
  snprintf(path, sizeof path, "%s/summary.txt", j->o->report);
  output_file out;
  if (!output_file_open(&out, path)) return fail(path);
  print_summary(j, out.stream, components, count);
  return output_file_keep(&out) || fail(path);
}

static int write_plots(run_job *j) {
  char path[PATH_ROOM];
  if (j->s.facts.hands != 0) {
    snprintf(path, sizeof path, "%s/forces.png", j->o->report);
    if (!run_trace_plot_forces(&j->trace, path)) return fail(path);
  }
  tear_force force;
  if (find_tear_force(j, &force)) {
    snprintf(path, sizeof path, "%s/tearing.png", j->o->report);
    if (!run_trace_plot_tearing(&j->trace, force.axis, path)) return fail(path);
  }
  snprintf(path, sizeof path, "%s/work.png", j->o->report);
  if (!run_trace_plot_work(&j->trace, path)) return fail(path);
  snprintf(path, sizeof path, "%s/pull.png", j->o->report);
  return run_trace_plot_pull(&j->trace, path) || fail(path);
}

/* The first signal since the run ended by itself, 0: none. After one that ended the run the report is written, and
 * the next ends the process. */
static int asked_to_end(const run_job *j) { return j->signal == 0 ? signals_seen() : 0; }

static int write_report(run_job *j, const component *components, uint32_t count) {
  const album_style style = {.folder = j->o->report, .width = 1280, .height = 960,
                             .yarn = j->s.facts.splits_max != 0,
                             .asked_to_end = j->signal == 0 ? signals_seen : NULL};
  if (!album_write(&j->pictures, &style) || (asked_to_end(j) == 0 && !write_plots(j))) return 0;
  if (asked_to_end(j) != 0)
    fprintf(stderr, "%s: not all of the report: signal %d ended it\n", j->o->report, asked_to_end(j));
  return write_summary(j, components, count);
}

static void print_end(run_job *j, const component *components, uint32_t count) {
  print_summary(j, stdout, components, count);
  printf("hash %016" PRIx64 " ticks %" PRIu64 " tears %u pieces %u faults %u\n",
         fray_hash(j->s.world_file.world), j->ticks, j->last.tears_total, count, j->faults);
}

static int run_live(run_job *j) {
  const run_options *o = j->o;
  const live_options live = {o->can,      o->record,   o->instance, o->ticks,
                             o->realtime, o->priority, o->cpu, o->workers, o->key};
  component components[COMPONENTS];
  live_result result;
  const int code = live_run(j->s.world_file.world, &live, &result);
  j->last = result.last;
  j->start = result.start;
  if (code == 2 || (o->save != NULL && !save(j))) return code == 2 ? 2 : 1;
  j->ticks = fray_get_info(j->s.world_file.world).tick - j->s.facts.tick;
  j->faults = j->last.faults;
  j->first_tear = UINT64_MAX;
  print_end(j, components, components_find(j->s.world_file.world, components, COMPONENTS));
  return code;
}

static int finish(run_job *j) {
  component components[COMPONENTS];
  const uint32_t count = components_find(j->s.world_file.world, components, COMPONENTS);
  if (j->o->save != NULL && !save(j)) return 0;
  if (j->o->report != NULL && !write_report(j, components, count)) return 0;
  print_end(j, components, count);
  if (j->signal == 0) j->signal = signals_seen();
  return 1;
}

static int run_all(run_job *j) {
  const session_log log = {j->o->log, j->o->key.file, j->o->cut, j->o->ticks};
  const int code = session_open(&j->s, j->o->file, &log, j->o->instance);
  if (code != 0) return code;
  if (!kernel_use(j->s.world_file.world, j->o->kernel)) {
    session_close(&j->s);
    return 2;
  }
  int result;
  j->out.aside = j->energy.aside = -1;
  if (j->o->can != NULL)
    result = run_live(j);
  else
    result = (j->o->report == NULL || album_make_folder(j->o->report)) && begin(j) && run_with_workers(j) &&
                     finish(j)
                 ? (j->signal != 0 ? 128 + j->signal : 0)
                 : 1;
  run_trace_close(&j->trace);
  work_tally_close(&j->tally);
  album_close(&j->pictures);
  output_file_drop(&j->out);
  output_file_drop(&j->energy);
  session_close(&j->s);
  return result;
}

int cmd_run(int argc, char **argv) {
  run_options o;
  run_job *j = world_workers_alloc(sizeof *j);
  memset(&o, 0, sizeof o);
  o.priority = PRIORITY;
  o.cpu = LIVE_ANY_CPU;
  o.workers = 1;
  const option table[] = {
      {"--log", &o.log, NULL, NULL, OPTION_INPUT, 0},
      {"--ticks", NULL, &o.ticks, NULL, 1, UINT32_MAX},
      {"--record", &o.record, NULL, NULL, OPTION_OUTPUT, 0},
      {"--report", &o.report, NULL, NULL, OPTION_FOLDER, 0},
      {"--save", &o.save, NULL, NULL, OPTION_OUTPUT, 0},
      {"--energy", &o.energy, NULL, NULL, OPTION_OUTPUT, 0},
      {"--instance", NULL, &o.instance, NULL, 0, 7},
      {"--can", &o.can, NULL, NULL, 0, 0},       {"--realtime", NULL, NULL, &o.realtime, 0, 0},
      {"--priority", NULL, &o.priority, NULL, 1, 99},
      {"--kernel", &o.kernel, NULL, NULL, 0, 0},
      {"--cut", NULL, NULL, &o.cut, 0, 0},
      {"--cpu", NULL, &o.cpu, NULL, 0, 1023},
      {"--workers", NULL, &o.workers, NULL, 0, FRAY_WORKERS_MAX},
      {"--key", &o.key.file, NULL, NULL, OPTION_INPUT, 0},
      {"--classic-tags", NULL, NULL, &o.key.classic_tags, 0, 0},
      {"--freshness", &o.key.freshness, NULL, NULL, OPTION_OUTPUT, 0}};
  const options_result wish =
      options_parse(argc, argv, table, sizeof table / sizeof table[0], &o.file);
  int code = 2;
  if (wish == OPTIONS_HELP || (wish == OPTIONS_GOOD && o.file == NULL)) {
    print_usage(wish == OPTIONS_HELP ? stdout : stderr);
    code = wish == OPTIONS_HELP ? 0 : 2;
  } else if (wish == OPTIONS_GOOD && o.can == NULL &&
             (o.realtime || o.priority != PRIORITY || o.cpu != LIVE_ANY_CPU)) {
    fprintf(stderr, "fray run: --realtime, --priority and --cpu go with --can\n");
  } else if (wish == OPTIONS_GOOD && o.can != NULL && (o.log != NULL || o.report != NULL || o.energy != NULL)) {
    fprintf(stderr, "fray run: --can excludes --log, --report and --energy; render or run its recording instead\n");
  } else if (wish == OPTIONS_GOOD && o.key.file != NULL && o.can == NULL && o.log == NULL) {
    fprintf(stderr, "fray run: --key goes with --can or --log\n");
  } else if (wish == OPTIONS_GOOD && o.cut && o.log == NULL) {
    fprintf(stderr, "fray run: --cut goes with --log\n");
  } else if (wish == OPTIONS_GOOD && j != NULL && bus_key_check("run", &o.key, o.can != NULL)) {
    j->o = &o;
    code = run_all(j);
  }
  free(j);
  return code;
}
