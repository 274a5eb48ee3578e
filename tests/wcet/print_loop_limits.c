/* SPDX-License-Identifier: Apache-2.0 */
/* limits_of NAME X.img ...: the lines of limits.h for images, on the host. */
#include <stdio.h>

#include "tests/wcet/loop_limits.h"
#include "tools/world/world_file.h"

void port_print(const char *text) { fputs(text, stdout); }

int main(int argc, char **argv) {
  for (int n = 1; n + 1 < argc; n += 2) {
    struct world_file o;
    if (world_file_open(argv[n + 1], &o, stderr) != 0) return 2;
    loop_limits_print(argv[n], o.world);
    world_file_close(&o);
  }
  return 0;
}
