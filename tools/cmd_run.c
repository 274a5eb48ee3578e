/* SPDX-License-Identifier: Apache-2.0 */
/* fray run: steps a world through a log, records the bus, and reports. */
#include "tools/cmd_run.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/crew.h"
#include "tools/kernel.h"
#include "tools/live.h"
#include "tools/loose_ends.h"
#include "tools/options.h"
#include "tools/pieces.h"
#include "tools/progress.h"
#include "tools/record.h"
#include "tools/render/album.h"
#include "tools/render/report_run.h"
#include "tools/session.h"
#include "tools/work_tally.h"

enum { DEFAULT_TICKS = 1000, PICTURES = 8, PATH_ROOM = 1024, PRIORITY = 80 };

typedef struct {
  const char *file, *log, *record, *report, *save, *can;
  uint32_t ticks, instance, priority, cpu, workers;
  int realtime;
  const char *kernel;
  bus_key_options key;
} run_options;

typedef struct {
  const run_options *o;
  session s;
  crew crew;
  uint32_t ticks;      /* to run */
  FILE *out;           /* the recording, or NULL */
  record recording;
  run_trace trace;
  work_tally tally;
  album pictures;
  fray_output last;
  uint32_t first_cut;  /* tick, or UINT32_MAX */
  uint16_t faults;     /* of all ticks */
} run_job;

static void print_usage(FILE *out) {
  fprintf(out,
          "usage: fray run X.scene|X.img [--log IN.log | --can IFACE] [options]\n\n"
          "Steps a world. Its inputs are the POSE and COMMAND frames of a log: a device log, by\n"
          "their times, or a recording, by its SYNCs.\n\n"
          "  --log FILE       inputs (candump -L); without it nothing moves the hands\n"
          "  --ticks N        how many ticks (default: the log's, or %d)\n"
          "  --record FILE    writes the bus as a candump log that `fray verify` accepts\n"
          "  --report DIR     pictures, plots of forces and work, summary.txt\n"
          "  --save FILE      writes the last state as an image\n"
          "  --kernel NAME    scalar, avx2, avx512, neon: the same hashes, other speeds (default:\n"
          "                   the fastest that this machine has)\n"
          "  --instance N     which runtime on the bus, 0 to 7 (default 0)\n"
          "  --can IFACE      runs on a SocketCAN interface until --ticks or SIGINT;\n"
          "                   --record then logs everything that passes on the bus\n"
          "  --realtime       SCHED_FIFO (--priority N, default 80) and locked memory\n"
          "  --cpu N          pins the process to a CPU, workers to those from it on\n"
          "  --workers N      threads that share a tick (default 1; 0: as many as are of use); the\n"
          "                   same hashes for any number\n"
          "  --key FILE       with --can: takes and sends POSE, COMMAND, FORCE, ACK with a tag\n"
          "                   under this key only, on CAN FD; with --log: of such a recording.\n"
          "                   32 hex digits, mode 0600\n"
          "  --classic-tags   with --key on classic CAN: wants a TAG after every fourth POSE;\n"
          "                   three bad ones in a row take it to SAFE until RESET\n"
          "  --freshness FILE keeps how far this end has come, so that one key lasts for many\n"
          "                   sessions; a file for each end\n\n"
          "The last line is `hash <16 hex> ticks <n> tears <n> pieces <n> faults <n>`.\n\n"
          "exit: 0 good, 1 the run failed, 2 wrong use or unreadable input\n",
          DEFAULT_TICKS);
}

static int fail(const char *path) {
  fprintf(stderr, "%s: cannot be written: %s\n", path, strerror(errno));
  return 0;
}

static int begin(run_job *j) {
  const fray_facts *f = &j->s.facts;
  j->ticks = j->o->ticks != 0 ? j->o->ticks : (j->o->log != NULL ? j->s.log.count : DEFAULT_TICKS);
  j->first_cut = UINT32_MAX;
  run_trace_open(&j->trace, f->rate_hz, f->hands);
  run_trace_watch(&j->trace, j->s.opened.world);
  work_tally_open(&j->tally, j->s.opened.world);
  album_open(&j->pictures);
  if (j->o->record != NULL) {
    j->out = fopen(j->o->record, "w");
    if (j->out == NULL) return fail(j->o->record);
    record_begin(&j->recording, j->out, j->o->instance, f->hands, f->rate_hz, f->tick,
                 fray_hash(j->s.opened.world));
    j->recording.sender.contacts_max = fray_limits(j->s.opened.world).contacts;
  }
  return 1;
}

/* Pictures at even distances, and one when the sheet begins to tear. */
static int take_picture(run_job *j, uint32_t n, int tore_first) {
  const uint32_t step = j->ticks / (PICTURES - 1) > 0 ? j->ticks / (PICTURES - 1) : 1;
  if (j->o->report == NULL || (n % step != 0 && n != j->ticks && !tore_first)) return 1;
  if (n + step > j->ticks && n != j->ticks && !tore_first) return 1;
  if (album_add(&j->pictures, j->s.opened.world)) return 1;
  fprintf(stderr, "fray run: not enough memory for pictures\n");
  return 0;
}

static int step(run_job *j, uint32_t n) {
  const fray_input *input = session_input(&j->s, n);
  team_tick(&j->crew.team, input, &j->last);
  j->faults |= j->last.faults;
  work_tally_add(&j->tally, &j->last);
  const int tore_first = j->first_cut == UINT32_MAX && j->last.work.cuts != 0;
  if (tore_first) j->first_cut = j->last.tick;
  if (j->o->report != NULL) run_trace_add(&j->trace, &j->last, j->s.opened.world);
  if (j->out != NULL && !record_tick(&j->recording, input, &j->last)) return fail(j->o->record);
  return take_picture(j, n + 1, tore_first);
}

static int run(run_job *j) {
  char what[64];
  if (!take_picture(j, 0, 0)) return 0;
  for (uint32_t n = 0; n < j->ticks; ++n) {
    if (!step(j, n)) return 0;
    snprintf(what, sizeof what, "run: %u springs cut", j->last.cuts_total);
    progress_show(what, n + 1, j->ticks);
  }
  progress_end();
  if (j->out == NULL) return 1;
  const int good = record_end(&j->recording);
  const int closed = fclose(j->out) == 0;
  j->out = NULL;
  return (good && closed) || fail(j->o->record);
}

static int run_crew(run_job *j) {
  if (!crew_open(&j->crew, j->s.opened.world, j->o->workers, TEAM_ANY_CPU)) return 0;
  const int good = run(j);
  crew_close(&j->crew);
  return good;
}

static int save(const run_job *j) {
  const size_t bytes = fray_save_bytes(j->s.opened.world);
  void *image = malloc(bytes);
  FILE *out = fopen(j->o->save, "wb");
  int good = image != NULL && out != NULL && fray_save(j->s.opened.world, image, bytes) == bytes &&
             fwrite(image, 1, bytes, out) == bytes;
  if (out != NULL) good = (fclose(out) == 0) && good;
  free(image);
  return good || fail(j->o->save);
}

static void print_pieces(const run_job *j, FILE *out, const piece *pieces, uint32_t count) {
  const char *of = j->s.facts.triangles_max != 0 ? "vertices" : j->s.facts.splits_max != 0 ? "particles" : "crossings";
  fprintf(out, "pieces       %u\n", count);
  for (uint32_t n = 0; n < count && n < 8; ++n) {
    fprintf(out, "             %u %s, %s", pieces[n].crossings, of, pieces[n].holders == 0 ? "loose" : "held by body");
    for (uint32_t b = 0; b < j->s.facts.bodies; ++b)
      if ((pieces[n].holders >> b & 1u) != 0) fprintf(out, " %u", b);
    fprintf(out, "\n");
  }
}

static void print_yarns(const run_job *j, FILE *out) {
  loose_ends e;
  if ((j->last.cuts_total == 0 && j->s.facts.splits_max == 0) || j->s.facts.triangles_max != 0) return;
  if (!loose_ends_find(j->s.opened.world, &e)) return;
  if (j->s.facts.splits_max != 0) {
    fprintf(out, "yarns        %u crossings split; %u loose, %u apart", e.split, e.loose, e.disconnected);
    if (e.connected != 0) fprintf(out, ", %u connected", e.connected);
    fprintf(out, "\n");
  }
  fprintf(out,
          "fray         %.3f cm of loose ends a cm of tear: %u ends, %.2f cm on %.2f cm; weave open "
          "%.3f cm wide\n",
          e.fray, e.ends, e.loose_cm, e.tear_cm, e.zone_cm);
}

/* What became of the frames of a device log. */
static void print_input(const port_statistics *p, FILE *out) {
  fprintf(out, "input        %u frames accepted", p->accepted);
  if (p->lost != 0) fprintf(out, ", %u lost", p->lost);
  if (p->repeated != 0) fprintf(out, ", %u repeated", p->repeated);
  if (p->old != 0) fprintf(out, ", %u too late", p->old);
  if (p->wrong_crc != 0) fprintf(out, ", %u with a wrong CRC", p->wrong_crc);
  if (p->wrong_length + p->wrong_flags + p->wrong_field != 0)
    fprintf(out, ", %u of a wrong form", p->wrong_length + p->wrong_flags + p->wrong_field);
  if (p->unknown_id != 0) fprintf(out, ", %u with an unknown id", p->unknown_id);
  if (p->queue_full != 0) fprintf(out, ", %u dropped", p->queue_full);
  fprintf(out, "\n");
}

static void print_summary(run_job *j, FILE *out, const piece *pieces, uint32_t count) {
  const fray_facts *f = &j->s.facts;
  const fray_work most = fray_limits(j->s.opened.world);
  fprintf(out, "scene        %s\n", j->o->file);
  fprintf(out, "rate         %u Hz, %u substeps, %u sweeps\n", f->rate_hz, f->substeps, f->sweeps);
  fprintf(out, "ticks        %u (%.3f s)\n", j->ticks, (double)j->ticks / f->rate_hz);
  if (j->o->log != NULL && !j->s.log.recording) print_input(&j->s.log.port, out);
  if (j->first_cut != UINT32_MAX)
    fprintf(out, "first tear   tick %u (%.3f s)\n", j->first_cut,
            (double)j->first_cut / f->rate_hz);
  if (f->triangles_max != 0)
    fprintf(out, "tears        %u, triangles %u of %u\n", j->last.cuts_total,
            fray_describe(j->s.opened.world).triangles, f->triangles_max);
  else
    fprintf(out, "springs cut  %u of %u\n", j->last.cuts_total, f->rows[FRAY_STRUCTURAL]);
  print_pieces(j, out, pieces, count);
  print_yarns(j, out);
  fprintf(out, "faults       0x%02X%s%s%s%s%s%s%s%s\n", j->faults,
          (j->faults & FRAY_FAULT_CUTS_WAIT) != 0 ? ", cuts waited (cuts_per_tick)" : "",
          (j->faults & FRAY_FAULT_CONTACTS_FULL) != 0 ? ", contacts full (limits contacts)" : "",
          (j->faults & FRAY_FAULT_LEFT_WORLD) != 0 ? ", held back at the edge of the world" : "",
          (j->faults & FRAY_FAULT_SPARES_FULL) != 0 ? ", spares full (limits spare_particles)" : "",
          (j->faults & FRAY_FAULT_SPLITS_WAIT) != 0 ? ", splits waited (splits_per_tick)" : "",
          (j->faults & FRAY_FAULT_SELVES) != 0 ? ", yarns moved as one (limits self_pairs)" : "",
          (j->faults & FRAY_FAULT_CROWDED) != 0 ? ", too much of a mesh near a particle" : "",
          (j->faults & FRAY_FAULT_JAMMED) != 0 ? ", particles jammed between meshes" : "");
  fprintf(out, "work bound   %u projections, %u predictions, %u contact tests a tick\n",
          most.projections, most.predictions, most.contacts);
  work_tally_print(&j->tally, out);
}

static int write_summary(run_job *j, const piece *pieces, uint32_t count) {
  char path[PATH_ROOM];
  snprintf(path, sizeof path, "%s/summary.txt", j->o->report);
  FILE *out = fopen(path, "w");
  if (out == NULL) return fail(path);
  print_summary(j, out, pieces, count);
  return fclose(out) == 0 || fail(path);
}

static int write_report(run_job *j, const piece *pieces, uint32_t count) {
  char path[PATH_ROOM];
  const album_style style = {.folder = j->o->report, .width = 1280, .height = 960};
  if (!album_write(&j->pictures, &style)) return 0;
  if (j->s.facts.hands != 0) {
    snprintf(path, sizeof path, "%s/forces.png", j->o->report);
    if (!plot_forces_write(&j->trace, path)) return fail(path);
  }
  snprintf(path, sizeof path, "%s/work.png", j->o->report);
  if (!plot_work_write(&j->trace, path)) return fail(path);
  snprintf(path, sizeof path, "%s/pull.png", j->o->report);
  if (!plot_pull_write(&j->trace, path)) return fail(path);
  return write_summary(j, pieces, count);
}

/* The hash, and what became of the sheet. */
static void print_end(run_job *j, const piece *pieces, uint32_t count) {
  print_summary(j, stdout, pieces, count);
  printf("hash %016" PRIx64 " ticks %u tears %u pieces %u faults %u\n",
         fray_hash(j->s.opened.world), j->ticks, j->last.cuts_total, count, j->faults);
}

static int run_live(run_job *j) {
  const run_options *o = j->o;
  const live_options live = {o->can,      o->record,   o->instance, o->ticks,
                             o->realtime, o->priority, o->cpu, o->workers, o->key};
  piece pieces[8];
  const int code = live_run(j->s.opened.world, &live, &j->last);
  if (code == 2 || (o->save != NULL && !save(j))) return code == 2 ? 2 : 1;
  j->ticks = fray_describe(j->s.opened.world).tick - j->s.facts.tick;
  j->faults = j->last.faults;
  j->first_cut = UINT32_MAX;
  print_end(j, pieces, pieces_find(j->s.opened.world, pieces, 8));
  return code;
}

static int finish(run_job *j) {
  piece pieces[8];
  const uint32_t count = pieces_find(j->s.opened.world, pieces, 8);
  if (j->o->save != NULL && !save(j)) return 0;
  if (j->o->report != NULL && !write_report(j, pieces, count)) return 0;
  print_end(j, pieces, count);
  return 1;
}

static int run_all(run_job *j) {
  const int code = session_open(&j->s, j->o->file, j->o->log, j->o->key.file, j->o->instance);
  if (code != 0) return code;
  if (!kernel_use(j->s.opened.world, j->o->kernel)) {
    session_close(&j->s);
    return 2;
  }
  int result;
  if (j->o->can != NULL)
    result = run_live(j);
  else
    result = (j->o->report == NULL || album_make_folder(j->o->report)) && begin(j) && run_crew(j) &&
                     finish(j)
                 ? 0
                 : 1;
  run_trace_close(&j->trace);
  work_tally_close(&j->tally);
  album_close(&j->pictures);
  if (j->out != NULL) fclose(j->out);
  session_close(&j->s);
  return result;
}

int cmd_run(int argc, char **argv) {
  run_options o;
  run_job *j = crew_room(sizeof *j);
  memset(&o, 0, sizeof o);
  o.priority = PRIORITY;
  o.cpu = LIVE_ANY_CPU;
  o.workers = 1;
  const option table[] = {
      {"--log", &o.log, NULL, NULL, 0, 0},       {"--ticks", NULL, &o.ticks, NULL, 1, 1u << 26},
      {"--record", &o.record, NULL, NULL, 0, 0}, {"--report", &o.report, NULL, NULL, 0, 0},
      {"--save", &o.save, NULL, NULL, 0, 0},     {"--instance", NULL, &o.instance, NULL, 0, 7},
      {"--can", &o.can, NULL, NULL, 0, 0},       {"--realtime", NULL, NULL, &o.realtime, 0, 0},
      {"--priority", NULL, &o.priority, NULL, 1, 99},
      {"--kernel", &o.kernel, NULL, NULL, 0, 0},
      {"--cpu", NULL, &o.cpu, NULL, 0, 1023},
      {"--workers", NULL, &o.workers, NULL, 0, FRAY_WORKERS_MAX},
      {"--key", &o.key.file, NULL, NULL, 0, 0},
      {"--classic-tags", NULL, NULL, &o.key.classic_tags, 0, 0},
      {"--freshness", &o.key.freshness, NULL, NULL, 0, 0}};
  const options_result wish =
      options_parse(argc, argv, table, sizeof table / sizeof table[0], &o.file);
  int code = 2;
  if (wish == OPTIONS_HELP || (wish == OPTIONS_GOOD && o.file == NULL)) {
    print_usage(wish == OPTIONS_HELP ? stdout : stderr);
    code = wish == OPTIONS_HELP ? 0 : 2;
  } else if (wish == OPTIONS_GOOD && o.can == NULL &&
             (o.realtime || o.priority != PRIORITY || o.cpu != LIVE_ANY_CPU)) {
    fprintf(stderr, "fray run: --realtime, --priority and --cpu go with --can\n");
  } else if (wish == OPTIONS_GOOD && o.can != NULL && (o.log != NULL || o.report != NULL)) {
    fprintf(stderr, "fray run: --can excludes --log and --report; render its recording instead\n");
  } else if (wish == OPTIONS_GOOD && o.key.file != NULL && o.can == NULL && o.log == NULL) {
    fprintf(stderr, "fray run: --key goes with --can or --log\n");
  } else if (wish == OPTIONS_GOOD && j != NULL && bus_key_check("run", &o.key, o.can != NULL)) {
    j->o = &o;
    code = run_all(j);
  }
  free(j);
  return code;
}
