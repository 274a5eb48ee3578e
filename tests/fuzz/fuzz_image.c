/* SPDX-License-Identifier: Apache-2.0 */
/* The image loader: any bytes, their CRC put right, are refused or are a world that runs three
 * ticks and can be saved, opened again and run to the same hash. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "rt/base/bytes.h"
#include "rt/model/image.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

enum { MEMORY_MAX = 1 << 22 };

static uint8_t *mended(const uint8_t *data, size_t bytes) {
  uint8_t *copy = malloc(bytes + 1);
  if (copy == NULL) return NULL;
  if (bytes != 0) memcpy(copy, data, bytes);
  if (bytes >= 4 * IMAGE_HEADER_WORDS) {
    const uint32_t length = bytes_load32(copy + 4 * IMAGE_BYTES_WORD);
    if (length >= IMAGE_CRC_FROM && length <= bytes)
      bytes_store32(copy + 4 * IMAGE_CRC_WORD,
                    bytes_crc32(copy + IMAGE_CRC_FROM, length - IMAGE_CRC_FROM));
  }
  return copy;
}

static fray_world *open_image(const uint8_t *image, size_t bytes, void **memory) {
  size_t needed = 0;
  fray_world *world = NULL;
  fray_error error;
  *memory = NULL;
  if (fray_bytes(image, bytes, &needed, &error) != FRAY_OK || needed > MEMORY_MAX) return NULL;
  *memory = aligned_alloc(FRAY_ALIGN, (needed + FRAY_ALIGN - 1) / FRAY_ALIGN * FRAY_ALIGN);
  if (*memory == NULL) return NULL;
  const fray_status status = fray_open(image, bytes, *memory, needed, &world, &error);
  if ((status == FRAY_OK) != (world != NULL) || (status != FRAY_OK && error.what[0] == 0)) abort();
  return world;
}

static uint64_t run(fray_world *world, uint32_t ticks) {
  static const fray_input input = {3, {{1000, -2000, 300, 1, 0}, {-9000, 1, 32767, 1, 15}}, FRAY_VERB_START, 1};
  fray_output output;
  output.hash = 0;
  for (uint32_t n = 0; n < ticks; ++n) fray_tick(world, &input, &output);
  return output.hash;
}

static void run_saved(fray_world *world) {
  void *memory;
  const size_t bytes = fray_save_bytes(world);
  uint8_t *saved = malloc(bytes);
  if (saved == NULL || fray_save(world, saved, bytes) != bytes) abort();
  fray_world *again = open_image(saved, bytes, &memory);
  if (again != NULL && run(again, 2) != run(world, 2)) abort();
  free(memory);
  free(saved);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes) {
  void *memory;
  uint8_t *image = mended(data, bytes);
  if (image == NULL) return 0;
  fray_world *world = open_image(image, bytes, &memory);
  if (world != NULL) {
    /* work is bounded by the image; what would only be slow is left out */
    const fray_work most = fray_limits(world);
    if (most.projections + most.contacts < 1u << 20) {
      (void)run(world, 3);
      run_saved(world);
    }
  }
  free(memory);
  free(image);
  return 0;
}
