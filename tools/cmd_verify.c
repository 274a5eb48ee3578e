/* SPDX-License-Identifier: Apache-2.0 */
/* fray verify: runs a recording again and holds every SYNC, FORCE, ACK and TEAR against it. */
#include "tools/cmd_verify.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rt/wire/dictionary.h"
#include "tools/crew.h"
#include "tools/kernel.h"
#include "tools/open.h"
#include "tools/options.h"
#include "tools/replay.h"
#include "tools/unseal.h"

enum { EXIT_SAME = 0, EXIT_DIFFERS = 1, EXIT_USAGE = 2 };

typedef struct {
  const char *log_file;
  const char *scene_file;
  const char *key_file;
  uint32_t instance, workers;
  int cut;
  const char *kernel;
} options;

/* One run against its recording. */
typedef struct {
  const replay *log;
  fray_world *world;
  crew crew;
  port_sender sender;
  size_t tears; /* compared so far */
  uint64_t hash;
} verifier;

static void print_usage(FILE *out) {
  fputs("usage: fray verify RUN.log --scene X.scene|X.img [--instance N] [--cut] [--key FILE]\n"
        "                   [--kernel NAME] [--workers N]\n"
        "\n"
        "Replays a recording (candump -L of the bus, with its SYNCs) and compares every tick:\n"
        "the hash in SYNC, and the FORCE, ACK and TEAR frames. Prints the first tick that\n"
        "differs, or `verified <n> ticks, hash <16 hex>`.\n"
        "\n"
        "  --scene FILE   the scene or image that the run started from\n"
        "  --instance N   which runtime on the bus, 0 to 7 (default 0)\n"
        "  --cut          the recording was broken off (kill -9, power): leaves out half a last\n"
        "                 line and what stands behind the last SYNC\n"
        "  --key FILE     of a recording under a key: frames without a good tag are no input, and\n"
        "                 are named with their line\n"
        "  --workers N    threads that share a tick (default 1; 0: as many as are of use)\n"
        "\n"
        "exit: 0 the same, 1 differs or the recording is not complete, 2 wrong use or input\n",
        out);
}

static void print_bytes(const uint8_t *data) {
  for (int n = 0; n < 8; ++n) printf("%02X", data[n]);
}

/* One frame of this run (NULL: it has none) against one of the log (line 0: it has none). */
static int compare_frame(uint32_t tick, const char *name, int line, const uint8_t *says,
                         const uint8_t *has) {
  if (line == 0 && has == NULL) return 1;
  if (line != 0 && has != NULL && memcmp(says, has, 8) == 0) return 1;
  printf("tick %" PRIu32 " differs: ", tick);
  if (line != 0) {
    printf("%s at line %d says ", name, line);
    print_bytes(says);
  } else {
    printf("the log has no %s", name);
  }
  printf(", this run has ");
  if (has != NULL) {
    print_bytes(has);
  } else {
    printf("none");
  }
  printf("\n");
  return 0;
}

static const uint8_t *frame_of(const frame *frames, uint32_t count, dictionary_message message,
                               uint32_t instance) {
  for (uint32_t n = 0; n < count; ++n) {
    if (frames[n].id == dictionary_id(message, instance)) return frames[n].data;
  }
  return NULL;
}

static int compare_outputs(verifier *v, const replay_tick *expected, const fray_output *output) {
  const uint32_t instance = v->sender.instance;
  const uint32_t tick = output->tick;
  frame frames[PORT_OUT];
  const uint32_t count = port_encode(&v->sender, output, frames);
  const uint8_t *left = frame_of(frames, count, MESSAGE_FORCE_LEFT, instance);
  const uint8_t *right = frame_of(frames, count, MESSAGE_FORCE_RIGHT, instance);
  const uint8_t *ack = frame_of(frames, count, MESSAGE_ACK, instance);
  const uint8_t *tear = frame_of(frames, count, MESSAGE_TEAR, instance);
  int same = compare_frame(tick, "FORCE left", expected->force_line[0], expected->force[0], left);
  same &= compare_frame(tick, "FORCE right", expected->force_line[1], expected->force[1], right);
  same &= compare_frame(tick, "ACK", expected->ack_line, expected->ack, ack);
  if (tear != NULL) {
    static const replay_tear NONE = {0, {0}};
    const replay_tear *says = v->tears < v->log->tear_count ? &v->log->tears[v->tears] : &NONE;
    same &= compare_frame(tick, "TEAR", says->line, says->data, tear);
    v->tears += 1;
  }
  return same;
}

static int compare_tick(verifier *v, uint32_t n) {
  const replay_tick *expected = &v->log->ticks[n];
  fray_output output;
  team_tick(&v->crew.team, &expected->input, &output);
  v->hash = output.hash;
  const uint32_t low = (uint32_t)(output.hash & 0xFFFFFFFFu);
  int same = 1;
  if (expected->hash_line != 0 && expected->hash != low) {
    printf("tick %" PRIu32 " differs: SYNC at line %d says %08" PRIx32 ", this run has %08" PRIx32
           "\n",
           output.tick, expected->hash_line, expected->hash, low);
    same = 0;
  }
  return compare_outputs(v, expected, &output) && same;
}

static int compare_start(const verifier *v, const char *file) {
  const fray_facts facts = fray_describe(v->world);
  const int line = v->log->count > 0 ? v->log->ticks[0].sync_line : 0;
  const uint32_t low = (uint32_t)(v->hash & 0xFFFFFFFFu);
  if (v->log->first != facts.tick) {
    printf("%s:%d: the recording starts with tick %" PRIu32 ", the image with tick %" PRIu32 "\n",
           file, line, v->log->first, facts.tick);
    return 0;
  }
  if (v->log->start_hash != low) {
    printf("the start differs: SYNC at line %d says %08" PRIx32 ", this image has %08" PRIx32
           "\n",
           line, v->log->start_hash, low);
    return 0;
  }
  return 1;
}

static int compare_all(verifier *v, const char *file) {
  if (!compare_start(v, file)) return EXIT_DIFFERS;
  for (uint32_t n = 0; n < v->log->count; ++n) {
    if (!compare_tick(v, n)) return EXIT_DIFFERS;
  }
  if (v->tears < v->log->tear_count) {
    printf("%s:%d: a TEAR that this run does not have\n", file, v->log->tears[v->tears].line);
    return EXIT_DIFFERS;
  }
  printf("verified %" PRIu32 " ticks, hash %016" PRIx64 "\n", v->log->count, v->hash);
  return EXIT_SAME;
}

static int verify_world(const options *o, candump_log *log, struct opened *opened) {
  candump_error error;
  replay run;
  const fray_facts facts = fray_describe(opened->world);
  const replay_setting setting = {o->instance, facts.hands, facts.rate_hz,
                                  {facts.consumed[0], facts.consumed[1]}};
  if (!replay_is_recording(log, o->instance)) {
    fprintf(stderr, "%s: no SYNC of instance %" PRIu32 ", expected a recording\n", o->log_file,
            o->instance);
    return EXIT_USAGE;
  }
  if (!unseal_log(o->log_file, log, o->key_file, o->instance, facts.hands, stderr)) return EXIT_USAGE;
  if (!replay_read(o->log_file, log, &setting, &run, &error)) {
    candump_print_error(stderr, &error);
    return EXIT_DIFFERS;
  }
  static verifier v;
  v = (verifier){.log = &run, .world = opened->world, .hash = fray_hash(opened->world)};
  port_sender_init(&v.sender, o->instance, setting.hands, facts.rate_hz);
  int code = EXIT_USAGE;
  if (crew_open(&v.crew, opened->world, o->workers, TEAM_ANY_CPU)) {
    code = compare_all(&v, o->log_file);
    crew_close(&v.crew);
  }
  replay_free(&run);
  return code;
}

/* As candump_load(), but takes a file that ends anywhere. */
static int load_cut(const options *o, candump_log *log, candump_error *error) {
  size_t bytes = 0;
  uint8_t *text = world_read_file(o->log_file, &bytes, stderr);
  if (text == NULL) return candump_fail(error, o->log_file, 0, 0, "expected a log");
  while (bytes > 0 && text[bytes - 1] != '\n') --bytes;
  const int good = candump_parse_all(o->log_file, (const char *)text, bytes, log, error);
  free(text);
  const uint32_t sync = dictionary_id(MESSAGE_SYNC, o->instance);
  while (good && log->count > 0 && log->entries[log->count - 1].frame.id != sync) --log->count;
  return good;
}

int cmd_verify(int argc, char **argv) {
  options o;
  candump_log log;
  candump_error error;
  struct opened opened;
  memset(&o, 0, sizeof o);
  o.workers = 1;
  const option table[] = {{"--scene", &o.scene_file, NULL, NULL, 0, 0},
                          {"--instance", NULL, &o.instance, NULL, 0, 7},
                          {"--key", &o.key_file, NULL, NULL, 0, 0},
                          {"--workers", NULL, &o.workers, NULL, 0, FRAY_WORKERS_MAX},
                          {"--cut", NULL, NULL, &o.cut, 0, 0},
                          {"--kernel", &o.kernel, NULL, NULL, 0, 0}};
  const options_result wish =
      options_parse(argc, argv, table, sizeof table / sizeof *table, &o.log_file);
  if (wish == OPTIONS_HELP) {
    print_usage(stdout);
    return EXIT_SAME;
  }
  if (wish == OPTIONS_GOOD && (o.log_file == NULL || o.scene_file == NULL))
    fprintf(stderr, "fray verify: expected a recording and --scene; fray verify --help tells more\n");
  if (wish == OPTIONS_WRONG || o.log_file == NULL || o.scene_file == NULL) return EXIT_USAGE;
  if (!(o.cut ? load_cut(&o, &log, &error) : candump_load(o.log_file, &log, &error))) {
    candump_print_error(stderr, &error);
    return EXIT_USAGE;
  }
  int code = world_open_file(o.scene_file, &opened, stderr);
  if (code == 0) {
    code = kernel_use(opened.world, o.kernel) ? verify_world(&o, &log, &opened) : EXIT_USAGE;
    world_close(&opened);
  }
  candump_free(&log);
  return code;
}
