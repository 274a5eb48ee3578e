/* SPDX-License-Identifier: Apache-2.0 */
/* alter flip FILE BIT             one bit of a file, on stdout
 * alter mend IMAGE BIT            the same, and the image's CRC put right
 * alter pose LOG TICK HAND AXIS   the lowest bit of one axis of the newest POSE before SYNC TICK,
 *                                 and its E2E check put right
 * alter seal LOG KEY               a plain log as one that was recorded under the key of a file
 * Damage that a test wants, exactly. exit: 0 written, 2 wrong use. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/log/candump.h"
#include "rt/base/bytes.h"
#include "rt/model/image.h"
#include "rt/wire/codec.h"
#include "rt/wire/dictionary.h"
#include "rt/wire/guard.h"
#include "tools/bus_key.h"
#include "tools/open.h"

static int flip(const char *path, size_t bit, int mend) {
  size_t bytes = 0;
  uint8_t *data = world_read_file(path, &bytes, stderr);
  if (data == NULL) return 2;
  if (bit / 8 >= bytes || (mend && bytes < IMAGE_CRC_FROM)) return 2;
  data[bit / 8] = (uint8_t)(data[bit / 8] ^ 1u << bit % 8);
  if (mend)
    bytes_store32(data + 4 * IMAGE_CRC_WORD,
                  bytes_crc32(data + IMAGE_CRC_FROM, bytes - IMAGE_CRC_FROM));
  const int good = fwrite(data, 1, bytes, stdout) == bytes && fflush(stdout) == 0;
  free(data);
  return good ? 0 : 2;
}

/* Entry of the newest POSE of the hand before the SYNC; -1: there is none. */
static long find_pose(const candump_log *log, uint32_t tick, uint32_t hand) {
  long found = -1;
  for (size_t n = 0; n < log->count; ++n) {
    codec_sync sync;
    fray_pose pose;
    if (codec_decode_sync(&log->entries[n].frame, 0, &sync) == CODEC_OK && sync.tick == tick)
      return found;
    if (codec_decode_pose(&log->entries[n].frame, 0, hand, &pose) == CODEC_OK) found = (long)n;
  }
  return -1;
}

static int alter_pose(const char *path, uint32_t tick, uint32_t hand, uint32_t axis) {
  candump_log log;
  candump_error error;
  if (!candump_load(path, &log, &error)) {
    candump_print_error(stderr, &error);
    return 2;
  }
  const long at = find_pose(&log, tick, hand);
  for (size_t n = 0; n < log.count; ++n) {
    frame *f = &log.entries[n].frame;
    fray_pose pose;
    if ((long)n == at && codec_decode_pose(f, 0, hand, &pose) == CODEC_OK) {
      int16_t *axes[3] = {&pose.x, &pose.y, &pose.z};
      *axes[axis] = (int16_t)(*axes[axis] ^ 1);
      codec_encode_pose(f, 0, hand, &pose);
    }
    if (!candump_write(stdout, "vcan0", log.entries[n].time_us, f)) return 2;
  }
  candump_free(&log);
  return at >= 0 && fflush(stdout) == 0 ? 0 : 2;
}

/* All COMMANDs are an operator's. */
static int seal(const char *path, const char *key_file) {
  candump_log log;
  candump_error error;
  cmac_key key;
  guard runtime, device;
  if (!bus_key_read(key_file, &key)) return 2;
  if (!candump_load(path, &log, &error)) {
    candump_print_error(stderr, &error);
    return 2;
  }
  guard_init(&runtime, &key, GUARD_FD, GUARD_RUNTIME, 0, 3);
  guard_init(&device, &key, GUARD_FD, GUARD_DEVICE, 0, 3);
  for (size_t n = 0; n < log.count; ++n) {
    frame *f = &log.entries[n].frame;
    if (!guard_seal(&device, f) || (f->fd == 0 && !guard_seal(&runtime, f))) return 2;
    if (!candump_write(stdout, "vcan0", log.entries[n].time_us, f)) return 2;
  }
  candump_free(&log);
  return fflush(stdout) == 0 ? 0 : 2;
}

static uint32_t number(const char *word) { return (uint32_t)strtoul(word, NULL, 10); }

int main(int argc, char **argv) {
  if (argc == 4 && strcmp(argv[1], "flip") == 0) return flip(argv[2], number(argv[3]), 0);
  if (argc == 4 && strcmp(argv[1], "mend") == 0) return flip(argv[2], number(argv[3]), 1);
  if (argc == 6 && strcmp(argv[1], "pose") == 0)
    return alter_pose(argv[2], number(argv[3]), number(argv[4]) & 1u, number(argv[5]) % 3u);
  if (argc == 4 && strcmp(argv[1], "seal") == 0) return seal(argv[2], argv[3]);
  fprintf(stderr, "alter: wrong use\n");
  return 2;
}
