/* SPDX-License-Identifier: Apache-2.0 */
/* The image loader: any bytes, their CRC and the hashes of topology and state put right, are refused with a reason, or
 * are a world that runs 200 ticks of hostile poses, or fewer where they are more work than RUN_WORK_MAX, and can be
 * saved, opened again and run to the same hashes. */
#include <stdint.h>

#include "tests/fuzz/bases.h"
#include "tests/fuzz/damage_fields.h"
#include "tests/fuzz/run_image.h"
#include "tests/lib/image_mend.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);
int LLVMFuzzerInitialize(int *argc, char ***argv);
size_t LLVMFuzzerMutate(uint8_t *data, size_t bytes, size_t room);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t bytes, size_t room, unsigned seed);

enum { MEMORY_MAX = 1 << 22, ANYWHERE = 8, LONG_ONE_IN = 32 };

/* Seeds lie in the last folder that libFuzzer was given. */
int LLVMFuzzerInitialize(int *argc, char ***argv) {
  if (*argc > 1) bases_read((*argv)[*argc - 1]);
  return 0;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t bytes, size_t room, unsigned seed) {
  uint64_t draws = seed;
  if (bases_below(ANYWHERE, &draws) == 0) return LLVMFuzzerMutate(data, bytes, room);
  size_t damaged = bytes;
  const base_image *base = bases_draw(&draws);
  if (base != NULL && base->bytes <= room) {
    damaged = base->bytes;
    memcpy(data, base->image, damaged);
  }
  damage_fields(data, damaged, (uint32_t)splitmix64(&draws)); /* which field does not go by which base */
  return damaged;
}

static fray_world *open_mended(uint8_t *image, size_t bytes, void **memory) {
  size_t needed = 0;
  fray_world *world = NULL;
  fray_error error = {FRAY_OK, 0, 0, ""};
  fray_status status = fray_memory_size(image, bytes, &needed, &error);
  *memory = NULL;
  if (status == FRAY_OK && needed > MEMORY_MAX) return NULL;
  if (status == FRAY_OK) {
    *memory = aligned_alloc(FRAY_ALIGN, (needed + FRAY_ALIGN - 1) / FRAY_ALIGN * FRAY_ALIGN);
    if (*memory == NULL) hostile_fail("no memory");
    status = image_mend_open(image, bytes, *memory, needed, &world, &error);
  }
  if ((status == FRAY_OK) != (world != NULL)) hostile_fail("a status without a world, or the other way round");
  if (status != FRAY_OK && error.what[0] == 0) hostile_fail("refused without a reason");
  return world;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes) {
  void *memory;
  uint8_t *image = malloc(bytes + (bytes == 0));
  if (image == NULL) return 0;
  if (bytes != 0) memcpy(image, data, bytes);
  run_count();
  fray_world *world = open_mended(image, bytes, &memory);
  if (world != NULL) {
    const uint32_t crc = bytes_crc32(image, bytes);
    const uint64_t work_max = crc % LONG_ONE_IN == 0 ? RUN_WORK_LONG : RUN_WORK_MAX;
    if (run_world(world, RUN_TICKS, work_max, crc) >= RUN_TICKS) bases_keep(image, bytes, crc);
  }
  free(memory);
  free(image);
  return 0;
}
