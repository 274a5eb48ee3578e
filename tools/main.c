/* SPDX-License-Identifier: Apache-2.0 */
/* The program `fray`: a command a file. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "platform/files/output_file.h"
#include "rt/fray.h"
#include "tools/cmd/cmd.h"
#include "tools/terminal/signals.h"

typedef struct {
  const char *name;
  int (*run)(int argc, char **argv);
  const char *what;
} command;

static const command commands[] = {
    {"scene", cmd_scene, "compile a text scene to an image"},
    {"run", cmd_run, "run a scene, with a log of the bus as input"},
    {"verify", cmd_verify, "replay a recording and compare every tick"},
    {"hand", cmd_hand, "write the log of a simulated two-handed device"},
    {"render", cmd_render, "draw a scene, or moments of a run"},
    {"info", cmd_info, "print pools, bytes, batches and work of an image"},
    {"bench", cmd_bench, "time projections and stages next to float loops"},
};
enum { COMMANDS = sizeof commands / sizeof commands[0] };

static void print_usage(FILE *out) {
  fprintf(out, "usage: fray COMMAND ...     (fray COMMAND --help lists its options)\n\n");
  for (int n = 0; n < COMMANDS; ++n) fprintf(out, "  %-8s %s\n", commands[n].name, commands[n].what);
  fprintf(out, "\nexit: 0 good, 1 the run differs or failed, 2 wrong use or unreadable input\n");
}

static int run_command(int argc, char **argv) {
  static char help[] = "--help";
  const char *word = argc >= 2 ? argv[1] : "";
  const int is_help = strcmp(word, "--help") == 0 || strcmp(word, "help") == 0 || strcmp(word, "-h") == 0;
  if (is_help && argc == 2) {
    print_usage(stdout);
    return 0;
  }
  if (is_help) { /* fray help COMMAND: as fray COMMAND --help */
    argv[1] = argv[2];
    argv[2] = help;
    argc = 3;
  }
  if (argc >= 2 && strcmp(argv[1], "--version") == 0) {
    printf("fray %s, image format %u.%u\n", FRAY_VERSION, FRAY_IMAGE_MAJOR, FRAY_IMAGE_MINOR);
    return 0;
  }
  for (int n = 0; argc >= 2 && n < COMMANDS; ++n)
    if (strcmp(argv[1], commands[n].name) == 0) return commands[n].run(argc - 1, argv + 1);
  if (argc >= 2) fprintf(stderr, "fray: no command '%s'\n", argv[1]);
  print_usage(stderr);
  return 2;
}

/* What was printed must have arrived. */
int main(int argc, char **argv) {
  signals_begin(output_file_drop_all);
  const int code = run_command(argc, argv);
  const int lost = ferror(stdout);
  errno = 0;
  if (fclose(stdout) == 0 && !lost) return code;
  fprintf(stderr, "fray: standard output cannot be written%s%s\n", errno != 0 ? ": " : "",
          errno != 0 ? strerror(errno) : "");
  return code != 0 ? code : 1;
}
