/* SPDX-License-Identifier: Apache-2.0 */
/* Carves a caller's buffer once. A dry arena (base NULL) only counts the bytes. */
#ifndef FRAY_BASE_ARENA_H
#define FRAY_BASE_ARENA_H

#include <stddef.h>
#include <stdint.h>

enum { ARENA_ALIGN = 16 };

typedef struct {
  uint8_t *base;
  size_t bytes; /* of the buffer; ignored when dry */
  size_t used;
} arena;

/* `count` elements of `element_bytes`, aligned to ARENA_ALIGN; NULL when dry.
 * The caller has checked that the whole plan fits. */
static inline void *arena_take(arena *a, size_t count, size_t element_bytes) {
  void *taken = a->base != NULL ? a->base + a->used : NULL;
  const size_t bytes = count * element_bytes;
  a->used += (bytes + ARENA_ALIGN - 1u) & ~(size_t)(ARENA_ALIGN - 1u);
  return taken;
}

#endif
