/* SPDX-License-Identifier: Apache-2.0 */
/* fray hand: a simulated two-handed device that follows a script, into a log or on a bus. */
#include "tools/cmd/cmd.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/files/input_file.h"
#include "platform/files/output_file.h"
#include "rt/wire/codec.h"
#include "tools/bus/hand_live.h"
#include "tools/world/world_file.h"
#include "tools/terminal/options.h"
#include "tools/recording/record.h"
#include "tools/bus/script.h"

enum { EXIT_GOOD = 0, EXIT_FAILED = 1, EXIT_USAGE = 2 };
enum { PATIENCE_MS = 2000 };

static void print_usage(FILE *out) {
  fputs("usage: fray hand -o OUT.log X.hand\n"
        "       fray hand --can IFACE X.hand [--free] [--patience MS] [--key FILE] [trouble]\n"
        "\n"
        "Writes the frames of a two-handed device that follows the script X.hand: a log in the\n"
        "format of `candump -L`, the same on every machine, for `fray run`. With --can it\n"
        "drives a real bus: a spring of 300 N/m pulls the device along the script, against the\n"
        "forces that it receives.\n"
        "\n"
        "  rate 1000 Hz          poses a second (default 1000)\n"
        "  seed 7                of the noise (default 1)\n"
        "  noise 4 um            on each axis (default none)\n"
        "  instance 0            which runtime on the bus, 0 to 7 (default 0)\n"
        "  duration 5 s\n"
        "  arm 0.3 kg 500 N/m 2  with --can: mass, stiffness, ticks of delay beside the bus's own\n"
        "  command 0.1 s start   start, stop, reset, zero or halt\n"
        "  left { 0 s 0 0 0 mm  5 s -25 2 0 mm }    keyframes: time, x y z; also right\n"
        "  (all times are within the duration)\n"
        "\n"
        "  -o FILE          the log\n"
        "  --can IFACE      or: the bus\n"
        "  --free           its own clock; without it, one pose a hand for each SYNC\n"
        "  --rigid          forces do not move it\n"
        "  --patience MS    ends after this time without a SYNC (default 2000, 0: never)\n"
        "  --key FILE       POSE and COMMAND carry a tag under this key, on CAN FD; forces without a\n"
        "                   valid one are ignored. 32 hex digits, mode 0600\n"
        "  --classic-tags   with --key on classic CAN: a TAG after every fourth POSE instead\n"
        "  --freshness FILE the counters of this end, so that one key lasts for many sessions;\n"
        "                   each end has its own file\n"
        "trouble, per thousand poses: --drop N --repeat N --reorder N --corrupt N;\n"
        "  --freeze MS (silent from then on), --jump MS (corner to corner from then on),\n"
        "  --flood HZ (extra frames, with --key forged ones too; at most a tenth of a second's\n"
        "  between two SYNCs), --seed N\n"
        "\n"
        "exit: 0 good, 1 writing failed or the runtime stopped sending, 2 wrong use or input\n",
        out);
}

/* The 4-bit counter of the n-th message, from 1: a port has seen 0 before the first. */
static uint8_t counter_of(uint32_t n) { return (uint8_t)((n + 1u) & 15u); }

static int write_frame(FILE *out, const script *s, uint32_t tick, const frame *f) {
  return candump_write(out, RECORD_INTERFACE, record_time_us(tick, s->rate_hz), f);
}

static int write_script(FILE *out, const script *s) {
  const uint32_t ticks = script_ticks(s);
  uint32_t commands = 0;
  frame f;
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    while (commands < s->commands &&
           script_tick_at(s, s->command[commands].time_us) == tick) {
      const codec_command command = {counter_of(commands), (uint8_t)s->command[commands].verb, 0};
      codec_encode_command(&f, s->instance, &command);
      if (!write_frame(out, s, tick, &f)) return 0;
      commands += 1;
    }
    for (uint32_t hand = 0; hand < FRAY_HANDS; ++hand) {
      if (s->keys[hand] == 0) continue;
      fray_pose pose = script_pose(s, hand, tick);
      pose.counter = counter_of(tick);
      codec_encode_pose(&f, s->instance, hand, &pose);
      if (!write_frame(out, s, tick, &f)) return 0;
    }
  }
  return 1;
}

static int write_log(const char *path, const script *s) {
  output_file out;
  int good = output_file_open(&out, path);
  if (good && !write_script(out.stream, s)) {
    good = 0;
    output_file_drop(&out);
  } else if (good) {
    good = output_file_keep(&out);
  }
  if (good) return EXIT_GOOD;
  fprintf(stderr, "%s: cannot be written: %s\n", path, output_file_reason());
  return EXIT_FAILED;
}

static int read_script(const char *path, script *s) {
  candump_error error;
  size_t bytes = 0;
  uint8_t *text = world_file_read(path, INPUT_FILE_SCRIPT_MAX, &bytes, stderr);
  if (text == NULL) return 0;
  const int good = script_parse(path, (const char *)text, bytes, s, &error);
  if (!good) candump_print_error(stderr, &error);
  free(text);
  return good;
}

static int run_script(const char *script_file, const char *out_file, const device_faults *faults,
                      const hand_live_options *live) {
  script *s = malloc(sizeof *s);
  int code = EXIT_USAGE;
  if (s == NULL) {
    fprintf(stderr, "fray hand: not enough memory\n");
    return EXIT_FAILED;
  }
  if (read_script(script_file, s))
    code = out_file != NULL ? write_log(out_file, s) : hand_live_run(s, faults, live);
  free(s);
  return code;
}

int cmd_hand(int argc, char **argv) {
  const char *out_file = NULL;
  const char *script_file = NULL;
  hand_live_options live = {NULL, 0, 0, PATIENCE_MS, {NULL, NULL, 0}};
  device_faults t = {0, 0, 0, 0, 0, 0, 0, 1};
  int rigid = 0;
  const option table[] = {
      {"-o", &out_file, NULL, NULL, OPTION_OUTPUT, 0},
      {"--can", &live.interface, NULL, NULL, 0, 0},
      {"--free", NULL, NULL, &live.free_running, 0, 0}, {"--rigid", NULL, NULL, &rigid, 0, 0},
      {"--patience", NULL, &live.timeout_ms, NULL, 0, 3600000},
      {"--drop", NULL, &t.drop, NULL, 0, 1000},     {"--repeat", NULL, &t.repeat, NULL, 0, 1000},
      {"--reorder", NULL, &t.reorder, NULL, 0, 1000},
      {"--corrupt", NULL, &t.corrupt, NULL, 0, 1000},
      {"--freeze", NULL, &t.freeze_ms, NULL, 1, 3600000},
      {"--jump", NULL, &t.jump_ms, NULL, 1, 3600000},
      {"--flood", NULL, &live.flood_hz, NULL, 1, 100000},
      {"--seed", NULL, &t.seed, NULL, 0, UINT32_MAX},
      {"--key", &live.key.file, NULL, NULL, OPTION_INPUT, 0},
      {"--classic-tags", NULL, NULL, &live.key.classic_tags, 0, 0},
      {"--freshness", &live.key.freshness, NULL, NULL, OPTION_OUTPUT, 0}};
  const options_result wish =
      options_parse(argc, argv, table, sizeof table / sizeof table[0], &script_file);
  if (wish == OPTIONS_HELP) {
    print_usage(stdout);
    return EXIT_GOOD;
  }
  const int one_target = (out_file != NULL) != (live.interface != NULL);
  if (wish == OPTIONS_GOOD && (!one_target || script_file == NULL))
    fprintf(stderr, "fray hand: expected a script and either -o OUT.log or --can IFACE; "
                    "fray hand --help tells more\n");
  if (wish == OPTIONS_WRONG || !one_target || script_file == NULL) return EXIT_USAGE;
  const device_faults none = {0, 0, 0, 0, 0, 0, 0, t.seed};
  if (out_file != NULL && (memcmp(&t, &none, sizeof t) != 0 || rigid || live.free_running ||
                           live.flood_hz != 0 || live.timeout_ms != PATIENCE_MS ||
                           live.key.file != NULL)) {
    fprintf(stderr, "fray hand: trouble, --free, --rigid, --patience and --key go with --can\n");
    return EXIT_USAGE;
  }
  if (!bus_key_check("hand", &live.key, live.interface != NULL)) return EXIT_USAGE;
  t.rigid = (uint32_t)rigid;
  return run_script(script_file, out_file, &t, &live);
}
