/* SPDX-License-Identifier: Apache-2.0 */
/* Divides a caller's buffer into arrays, once. An arena without a buffer (base NULL, "dry") only counts
 * bytes. */
#ifndef FRAY_BASE_ARENA_H
#define FRAY_BASE_ARENA_H

#include <stddef.h>
#include <stdint.h>

#include "rt/base/assert.h"

enum { ARENA_ALIGN = 16 };

typedef struct {
  uint8_t *base;
  size_t bytes; /* size of the buffer; ignored when dry */
  size_t used;
} arena;

/* `count` elements of `element_bytes`, aligned to ARENA_ALIGN; NULL when dry.
 * The caller has checked that the whole plan fits. */
static inline void *arena_take(arena *a, size_t count, size_t element_bytes) {
  void *taken = a->base != NULL ? a->base + a->used : NULL;
  const size_t bytes = count * element_bytes;
  FRAY_ASSERT((a->used & (ARENA_ALIGN - 1u)) == 0 && (element_bytes == 0 || bytes / element_bytes == count));
  a->used += (bytes + ARENA_ALIGN - 1u) & ~(size_t)(ARENA_ALIGN - 1u);
  FRAY_ASSERT(a->base == NULL || a->used <= a->bytes);
  return taken;
}

#endif
