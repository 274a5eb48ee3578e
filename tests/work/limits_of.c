/* SPDX-License-Identifier: Apache-2.0 */
/* limits_of NAME X.img ...: the lines of limits.h for images, on the host. */
#include <stdio.h>

#include "tests/work/limits.h"
#include "tools/open.h"

void port_print(const char *text) { fputs(text, stdout); }

int main(int argc, char **argv) {
  for (int n = 1; n + 1 < argc; n += 2) {
    struct opened o;
    if (world_open_file(argv[n + 1], &o, stderr) != 0) return 2;
    limits_print(argv[n], o.world);
    world_close(&o);
  }
  return 0;
}
