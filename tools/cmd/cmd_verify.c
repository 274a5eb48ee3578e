/* SPDX-License-Identifier: Apache-2.0 */
/* fray verify: replays a recording and compares every frame of the runtime. */
#include "tools/cmd/cmd.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/world/world_workers.h"
#include "tools/world/kernel.h"
#include "tools/world/world_file.h"
#include "tools/terminal/options.h"
#include "rt/wire/codec.h"
#include "tools/recording/log_file.h"
#include "tools/recording/replay.h"
#include "tools/recording/unseal.h"
#include "tools/recording/verify.h"

enum { EXIT_SAME = 0, EXIT_DIFFERS = 1, EXIT_USAGE = 2 };

typedef struct {
  const char *log_file;
  const char *scene_file;
  const char *key_file;
  uint32_t instance, workers;
  int cut;
  const char *kernel;
} options;

static void print_usage(FILE *out) {
  fputs("usage: fray verify RUN.log --scene X.scene|X.img [--instance N] [--cut] [--key FILE]\n"
        "                   [--kernel NAME] [--workers N]\n"
        "\n"
        "Replays a recording (candump -L of the bus, with its SYNCs) and compares every tick:\n"
        "the hash in SYNC, and the FORCE, ACK, TEAR, STATUS and IDENTITY frames. Prints the\n"
        "first tick that differs, or `verified <n> ticks, hash <16 hex>`. A recording ends with a\n"
        "closing SYNC, which has the hash after its last tick.\n"
        "\n"
        "  --scene FILE   the scene or image that the run started from\n"
        "  --instance N   which runtime on the bus, 0 to 7 (default 0)\n"
        "  --cut          the recording was interrupted (kill -9, power): skips an incomplete last\n"
        "                 line and a last tick without a hash, and says so; also what is behind a\n"
        "                 gap that a slow disk left\n"
        "  --key FILE     the key of an authenticated recording: frames without a valid tag are\n"
        "                 refused, with their line\n"
        "  --kernel NAME  scalar, avx2, avx512, neon: the same hashes, other speeds (default: the\n"
        "                 fastest that this machine has)\n"
        "  --workers N    threads that share a tick (default 1; 0: as many as are useful)\n"
        "\n"
        "exit: 0 the same, 1 differs or the recording is not complete, 2 wrong use or input\n",
        out);
}

/* Whether the first SYNC is of the world's tick and has another hash than the world before it. */
static int starts_elsewhere(const candump_log *log, uint32_t instance, uint64_t tick, uint64_t hash) {
  codec_sync sync;
  for (size_t n = 0; n < log->count; ++n)
    if (codec_decode_sync(&log->entries[n].frame, instance, &sync) == CODEC_OK)
      return sync.tick == (uint32_t)(tick & UINT32_MAX) && sync.hash != (uint32_t)(hash & UINT32_MAX);
  return 0;
}

static int verify_world(const options *o, candump_log *log, struct world_file *world_file) {
  static world_workers w;
  const verify_recording of = {o->log_file, log, o->instance, o->cut};
  const fray_info facts = fray_get_info(world_file->world);
  const int elsewhere = starts_elsewhere(log, o->instance, facts.tick, fray_hash(world_file->world));
  if (!replay_is_recording(log, o->instance)) {
    fprintf(stderr, "%s: no SYNC of instance %" PRIu32 ", expected a recording\n", o->log_file,
            o->instance);
    return EXIT_USAGE;
  }
  if (!unseal_log(o->log_file, log, o->key_file, o->instance, facts.hands, stderr)) return EXIT_USAGE;
  if (!world_workers_open(&w, world_file->world, o->workers, WORKERS_ANY_CPU)) return EXIT_USAGE;
  const int same = verify_run(&of, world_file->world, &w.group, stdout, stderr);
  world_workers_close(&w);
  if (!same && elsewhere)
    fprintf(stderr, "%s starts from another state than %s: is this the scene of the recording?\n", o->log_file,
            o->scene_file);
  return same ? EXIT_SAME : EXIT_DIFFERS;
}

int cmd_verify(int argc, char **argv) {
  options o;
  candump_log log;
  struct world_file world_file;
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
  switch (log_file_load(o.log_file, o.cut, &log, stderr)) {
    case LOG_FILE_INCOMPLETE: return EXIT_DIFFERS;
    case LOG_FILE_REFUSED: return EXIT_USAGE;
    case LOG_FILE_GOOD: break;
  }
  int code = world_file_open(o.scene_file, &world_file, stderr);
  if (code == 0) {
    code = kernel_use(world_file.world, o.kernel) ? verify_world(&o, &log, &world_file) : EXIT_USAGE;
    world_file_close(&world_file);
  }
  candump_free(&log);
  return code;
}
