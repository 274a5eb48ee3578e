/* SPDX-License-Identifier: Apache-2.0 */
/* alter flip FILE BIT             one bit of a file, on stdout
 * alter mend IMAGE BIT            the same, and the image's CRC put right
 * alter word IMAGE WORD VALUE     a word of the header, and the CRC
 * alter tick IMAGE TICK           a world that is so old
 * alter pose LOG TICK HAND AXIS   the lowest bit of one axis of the newest POSE before SYNC TICK,
 *                                 and its E2E check put right
 * alter seal LOG KEY               a plain log as one that was recorded under the key of a file
 * Damage that a test wants, exactly. exit: 0 written, 2 wrong use. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/files/input_file.h"
#include "platform/log/candump.h"
#include "rt/base/bytes.h"
#include "rt/image/image.h"
#include "rt/wire/codec.h"
#include "rt/wire/dictionary.h"
#include "rt/wire/auth_gate.h"
#include "tests/lib/set_tick.h"
#include "tools/bus/bus_key.h"
#include "tools/world/world_file.h"

static int write_out(const uint8_t *data, size_t bytes) {
  return fwrite(data, 1, bytes, stdout) == bytes && fflush(stdout) == 0 ? 0 : 2;
}

static void mend_crc(uint8_t *data, size_t bytes) {
  bytes_store32(data + 4 * IMAGE_CRC_WORD, bytes_crc32(data + IMAGE_CRC_FROM, bytes - IMAGE_CRC_FROM));
}

static int flip(const char *path, size_t bit, int mend) {
  size_t bytes = 0;
  uint8_t *data = world_file_read(path, INPUT_FILE_WORLD_MAX, &bytes, stderr);
  if (data == NULL) return 2;
  if (bit / 8 >= bytes || (mend && bytes < IMAGE_CRC_FROM)) return 2;
  data[bit / 8] = (uint8_t)(data[bit / 8] ^ 1u << bit % 8);
  if (mend) mend_crc(data, bytes);
  const int code = write_out(data, bytes);
  free(data);
  return code;
}

static int set_word(const char *path, uint32_t word, uint32_t value) {
  size_t bytes = 0;
  uint8_t *data = world_file_read(path, INPUT_FILE_WORLD_MAX, &bytes, stderr);
  if (data == NULL || word >= IMAGE_HEADER_WORDS || bytes < 4 * IMAGE_HEADER_WORDS) return 2;
  bytes_store32(data + 4 * word, value);
  mend_crc(data, bytes);
  const int code = write_out(data, bytes);
  free(data);
  return code;
}

static int age(const char *path, uint64_t tick) {
  struct world_file o;
  if (world_file_open(path, &o, stderr) != 0) return 2;
  set_tick(o.world, tick);
  const size_t bytes = fray_save_bytes(o.world);
  uint8_t *data = malloc(bytes);
  const int code = data != NULL && fray_save(o.world, data, bytes) == bytes ? write_out(data, bytes) : 2;
  free(data);
  world_file_close(&o);
  return code;
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
  auth_gate runtime, device;
  if (!bus_key_read(key_file, &key)) return 2;
  if (!candump_load(path, &log, &error)) {
    candump_print_error(stderr, &error);
    return 2;
  }
  auth_gate_init(&runtime, &key, AUTH_GATE_FD, AUTH_GATE_RUNTIME, 0, 3);
  auth_gate_init(&device, &key, AUTH_GATE_FD, AUTH_GATE_DEVICE, 0, 3);
  for (size_t n = 0; n < log.count; ++n) {
    frame *f = &log.entries[n].frame;
    if (!auth_gate_seal(&device, f) || (f->fd == 0 && !auth_gate_seal(&runtime, f))) return 2;
    if (!candump_write(stdout, "vcan0", log.entries[n].time_us, f)) return 2;
  }
  candump_free(&log);
  return fflush(stdout) == 0 ? 0 : 2;
}

static uint32_t number(const char *word) { return (uint32_t)strtoul(word, NULL, 10); }

int main(int argc, char **argv) {
  if (argc == 4 && strcmp(argv[1], "flip") == 0) return flip(argv[2], number(argv[3]), 0);
  if (argc == 4 && strcmp(argv[1], "mend") == 0) return flip(argv[2], number(argv[3]), 1);
  if (argc == 5 && strcmp(argv[1], "word") == 0) return set_word(argv[2], number(argv[3]), number(argv[4]));
  if (argc == 4 && strcmp(argv[1], "tick") == 0) return age(argv[2], strtoull(argv[3], NULL, 10));
  if (argc == 6 && strcmp(argv[1], "pose") == 0)
    return alter_pose(argv[2], number(argv[3]), number(argv[4]) & 1u, number(argv[5]) % 3u);
  if (argc == 4 && strcmp(argv[1], "seal") == 0) return seal(argv[2], argv[3]);
  fprintf(stderr, "alter: wrong use\n");
  return 2;
}
