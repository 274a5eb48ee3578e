/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L

#include "tools/bench/machine.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#ifdef __clang__
#define COMPILER "clang " __clang_version__
#else
#define COMPILER "gcc " __VERSION__
#endif

/* "model name : X", on some machines "Model : X". */
static int take_name(const char *line, machine *m) {
  if (strncmp(line, "model name", 10) != 0 && strncmp(line, "Model", 5) != 0) return 0;
  const char *name = strchr(line, ':');
  if (name == NULL) return 0;
  name += strspn(name, ": \t");
  snprintf(m->processor, sizeof m->processor, "%.*s", (int)strcspn(name, "\n"), name);
  return m->processor[0] != 0;
}

machine machine_here(void) {
  machine m = {"unknown", sysconf(_SC_NPROCESSORS_ONLN), COMPILER};
  char line[256];
  FILE *in = fopen("/proc/cpuinfo", "r");
  while (in != NULL && fgets(line, sizeof line, in) != NULL)
    if (take_name(line, &m)) break;
  if (in != NULL) fclose(in);
  return m;
}
