/* SPDX-License-Identifier: Apache-2.0 */
/* The image loader: any bytes, their CRC and the hashes of topology and state put right, are refused with a reason,
 * or are a world that runs 20 ticks of hostile poses, one of ten 200, and can be saved, opened again and run to the
 * same hashes. */
#include <stdint.h>

#include "tests/fuzz/damage_fields.h"
#include "tests/fuzz/run_image.h"
#include "tests/lib/image_mend.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);
size_t LLVMFuzzerMutate(uint8_t *data, size_t bytes, size_t room);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t bytes, size_t room, unsigned seed);

enum { MEMORY_MAX = 1 << 22, ANYWHERE = 8, SHORT = 20, LONG = 10, KINDS = 8, OF_A_KIND = 64, KEPT = KINDS * OF_A_KIND };

/* Images that were accepted, as many of each kind, which the minor version says: what is damaged next. libFuzzer's
 * corpus is mostly images that were refused, each in another way, and what is damaged twice is refused again. */
static struct {
  uint8_t *image;
  size_t bytes;
} kept[KEPT];

static void keep(const uint8_t *image, size_t bytes, uint32_t draw) {
  const uint32_t slot = draw % OF_A_KIND * KINDS + bytes_load32(image + 4 * IMAGE_VERSION_WORD) % KINDS;
  free(kept[slot].image);
  kept[slot].image = malloc(bytes);
  kept[slot].bytes = bytes;
  if (kept[slot].image == NULL) hostile_fail("no memory");
  memcpy(kept[slot].image, image, bytes);
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t bytes, size_t room, unsigned seed) {
  const uint32_t slot = seed / ANYWHERE % KEPT;
  if (seed % ANYWHERE == 0) return LLVMFuzzerMutate(data, bytes, room);
  size_t damaged = bytes;
  if (kept[slot].image != NULL && kept[slot].bytes <= room) {
    damaged = kept[slot].bytes;
    memcpy(data, kept[slot].image, damaged);
  }
  damage_fields(data, damaged, seed);
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
    keep(image, bytes, crc);
    run_world(world, crc % LONG == 0 ? RUN_TICKS : SHORT, crc);
  }
  free(memory);
  free(image);
  return 0;
}
