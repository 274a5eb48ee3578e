/* SPDX-License-Identifier: Apache-2.0 */
/* Logs: any text is refused with a place in it, or is frames; frames go through replay as a
 * recording or a device log, and what is written again reads the same. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "platform/log/candump.h"
#include "tests/fuzz/run_image.h"
#include "tools/recording/replay.h"
#include "tools/recording/unseal.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

static void check_written(const candump_entry *entry) {
  char text[CANDUMP_TEXT];
  candump_entry again;
  candump_error error;
  const size_t length = candump_format(text, "vcan0", entry->time_us, &entry->frame);
  if (length == 0 || text[length - 1] != '\n') abort();
  if (candump_parse(text, length - 1, entry->line, &again, &error) != 1) abort();
  const int64_t time_us = entry->time_us == CANDUMP_NO_TIME ? 0 : entry->time_us;
  if (again.time_us != time_us || again.frame.id != entry->frame.id ||
      again.frame.length != entry->frame.length)
    abort();
}

/* A device log of hours is only slow. */
static int is_short(const candump_log *log) {
  for (size_t n = 0; n < log->count; ++n) {
    const int64_t since = log->entries[n].time_us - log->entries[0].time_us;
    if (since > 2000000) return 0;
  }
  return 1;
}

/* Whatever the log holds, nobody could make a tag of this key. */
static void check_under_a_key(candump_log *log) {
  static const uint8_t BYTES[CMAC_KEY] = {7, 7, 7};
  unseal_counts counts;
  cmac_key key;
  const size_t before = log->count;
  cmac_key_init(&key, BYTES);
  unseal_fd("fuzz.log", log, &key, 0, &counts, NULL);
  if (counts.good != 0 || log->count + counts.refused != before) abort();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes) {
  candump_log log;
  candump_error error = {0};
  char *text = malloc(bytes + (bytes == 0));
  if (text == NULL) return 0;
  run_count();
  if (bytes != 0) memcpy(text, data, bytes);
  if (candump_parse_all("fuzz.log", text, bytes, &log, &error)) {
    for (size_t n = 0; n < log.count; ++n) check_written(&log.entries[n]);
    run_tally.ran += 1;
    const replay_setting setting = {0, 3, 1000, 0, {0, 0}, (int)(bytes & 1), 0};
    replay run;
    if (log.count != 0 && is_short(&log) && replay_read("fuzz.log", &log, &setting, &run, &error))
      replay_free(&run);
    check_under_a_key(&log);
    candump_free(&log);
  } else if (error.message[0] == 0) {
    abort();
  }
  free(text);
  return 0;
}
