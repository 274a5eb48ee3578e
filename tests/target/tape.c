/* SPDX-License-Identifier: Apache-2.0 */
/* tape RECORDING: writes a recording of `fray run --record` as the C array that a player
 * (platform/playback/player.h) takes, to stdout. Runs on the host. */
#include <inttypes.h>
#include <stdio.h>

#include "platform/log/candump.h"

int main(int argc, char **argv) {
  candump_log log;
  candump_error error;
  if (argc != 2) return 2;
  if (!candump_load(argv[1], &log, &error)) {
    candump_print_error(stderr, &error);
    return 2;
  }
  printf("#include \"platform/playback/player.h\"\n"
         "extern const player_frame recording[];\nextern const uint32_t recording_count;\n"
         "const player_frame recording[] = {\n");
  for (size_t n = 0; n < log.count; ++n) {
    const frame *f = &log.entries[n].frame;
    if (f->extended || f->rtr || f->error || f->length != 8) {
      fprintf(stderr, "%s:%d: expected a message of eight bytes\n", argv[1], log.entries[n].line);
      return 2;
    }
    printf("{%" PRIu32 ",{", f->id);
    for (int k = 0; k < 8; ++k) printf("%u,", f->data[k]);
    printf("}},\n");
  }
  printf("};\nconst uint32_t recording_count = %zu;\n", log.count);
  candump_free(&log);
  return fflush(stdout) == 0 ? 0 : 1;
}
