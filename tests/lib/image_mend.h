/* SPDX-License-Identifier: Apache-2.0 */
/* Damaged images, put right in what they say of themselves: the CRC, and the hashes of topology and state.
 * So that what was damaged is what the loader judges, and what then runs. */
#ifndef FRAY_TESTS_LIB_IMAGE_MEND_H
#define FRAY_TESTS_LIB_IMAGE_MEND_H

#include <string.h>

#include "rt/base/bytes.h"
#include "rt/image/image.h"
#include "rt/image/state_hash.h"

static inline void image_mend_crc(uint8_t *image, size_t bytes) {
  if (bytes < 4 * IMAGE_HEADER_WORDS) return;
  const uint32_t length = bytes_load32(image + 4 * IMAGE_BYTES_WORD);
  if (length < IMAGE_CRC_FROM || length > bytes) return;
  bytes_store32(image + 4 * IMAGE_CRC_WORD, bytes_crc32(image + IMAGE_CRC_FROM, length - IMAGE_CRC_FROM));
}

/* A section that the directory names. */
static inline uint8_t *image_mend_section(uint8_t *image, uint32_t id) {
  const uint8_t *entry = image + 4 * IMAGE_HEADER_WORDS;
  while (bytes_load32(entry) != id) entry += 4 * IMAGE_DIRECTORY_WORDS;
  return image + bytes_load32(entry + 12);
}

/* fray_open() of the image with its CRC and both hashes put right. */
static inline fray_status image_mend_open(uint8_t *image, size_t bytes, void *memory, size_t memory_bytes,
                                          fray_world **world, fray_error *error) {
  enum { IN_STATE = 2, TOPOLOGY = offsetof(state, topology) / 4, HASH = offsetof(state, hash) / 4 };
  image_mend_crc(image, bytes);
  const fray_status status = fray_open(image, bytes, memory, memory_bytes, world, error);
  if (status != FRAY_BAD_FIELD || error->section != IN_STATE || (error->index != TOPOLOGY && error->index != HASH) ||
      strstr(error->what, "the hash of") == NULL)
    return status;
  /* everything else is good: the refused world lies whole in the memory */
  fray_world *w = memory;
  uint8_t *words = image_mend_section(image, IN_STATE);
  const uint64_t topology = world_topology(w);
  w->state->topology[0] = (int32_t)(uint32_t)topology;
  w->state->topology[1] = (int32_t)(uint32_t)(topology >> 32);
  const uint64_t found = state_hash(w);
  bytes_store32(words + 4 * TOPOLOGY, (uint32_t)topology);
  bytes_store32(words + 4 * TOPOLOGY + 4, (uint32_t)(topology >> 32));
  bytes_store32(words + 4 * HASH, (uint32_t)found);
  bytes_store32(words + 4 * HASH + 4, (uint32_t)(found >> 32));
  image_mend_crc(image, bytes);
  return fray_open(image, bytes, memory, memory_bytes, world, error);
}

#endif
