/* SPDX-License-Identifier: Apache-2.0 */
/* The `fray` command: one verb, one file. */
#include <stdio.h>
#include <string.h>

#include "rt/fray.h"
#include "tools/cmd_bench.h"
#include "tools/cmd_hand.h"
#include "tools/cmd_info.h"
#include "tools/cmd_render.h"
#include "tools/cmd_run.h"
#include "tools/cmd_scene.h"
#include "tools/cmd_verify.h"

typedef struct {
  const char *name;
  int (*run)(int argc, char **argv);
  const char *what;
} verb;

static const verb verbs[] = {
    {"scene", cmd_scene, "compile a text scene to an image"},
    {"run", cmd_run, "run a scene, with a log of the bus as input"},
    {"verify", cmd_verify, "replay a recording and compare every tick"},
    {"hand", cmd_hand, "write the log of a simulated two-handed device"},
    {"render", cmd_render, "draw a scene, or moments of a run"},
    {"info", cmd_info, "print pools, bytes, batches and work of an image"},
    {"bench", cmd_bench, "time projections and stages next to float loops"},
};
enum { VERBS = sizeof verbs / sizeof verbs[0] };

static void print_usage(FILE *out) {
  fprintf(out, "usage: fray VERB ...     (fray VERB --help tells more)\n\n");
  for (int n = 0; n < VERBS; ++n) fprintf(out, "  %-8s %s\n", verbs[n].name, verbs[n].what);
  fprintf(out, "\nexit: 0 good, 1 the run differs or failed, 2 wrong use or unreadable input\n");
}

int main(int argc, char **argv) {
  if (argc >= 2 && (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "help") == 0 || strcmp(argv[1], "-h") == 0)) {
    print_usage(stdout);
    return 0;
  }
  if (argc >= 2 && strcmp(argv[1], "--version") == 0) {
    printf("fray %s, image format %u.%u\n", FRAY_VERSION, FRAY_IMAGE_MAJOR, FRAY_IMAGE_MINOR);
    return 0;
  }
  for (int n = 0; argc >= 2 && n < VERBS; ++n)
    if (strcmp(argv[1], verbs[n].name) == 0) return verbs[n].run(argc - 1, argv + 1);
  if (argc >= 2) fprintf(stderr, "fray: no verb '%s'\n", argv[1]);
  print_usage(stderr);
  return 2;
}
