/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/recording/log_file.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "platform/files/input_file.h"
#include "tools/world/world_file.h"

/* Like candump_load(), for a file that may end anywhere. */
static int load_cut(const char *file, candump_log *log, candump_error *error) {
  size_t bytes = 0;
  uint8_t *text = world_file_read(file, INPUT_FILE_LOG_MAX, &bytes, stderr);
  if (text == NULL) return candump_fail(error, file, 0, 0, "expected a log");
  const char *gap = strstr((const char *)text, "\n" CANDUMP_GAP);
  if (gap != NULL) bytes = (size_t)(gap + 1 - (const char *)text);
  while (bytes > 0 && text[bytes - 1] != '\n') --bytes;
  const int good = candump_parse_all(file, (const char *)text, bytes, log, error);
  free(text);
  return good;
}

log_file_result log_file_load(const char *file, int cut, candump_log *log, FILE *err) {
  candump_error error;
  if (!(cut ? load_cut(file, log, &error) : candump_load(file, log, &error))) {
    candump_print_error(err, &error);
    return error.incomplete ? LOG_FILE_INCOMPLETE : LOG_FILE_REFUSED;
  }
  if (log->others == 0) return LOG_FILE_GOOD;
  if (log->count == 0) {
    fprintf(err, "%s:%d: is no frame, expected a log of a bus, as candump -L writes it\n", file, log->other_line);
    return LOG_FILE_REFUSED;
  }
  fprintf(err, "%s: note: %zu lines are no frames, the first at line %d\n", file, log->others, log->other_line);
  return LOG_FILE_GOOD;
}
