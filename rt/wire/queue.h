/* SPDX-License-Identifier: Apache-2.0 */
/* A bounded queue of received messages: 10 bytes each, since only 8-byte messages of three kinds reach it.
 *
 * Contract of all functions here. Context: any thread or interrupt, one at a time for each queue.
 * NULL: never. Errors: none but the result. A queue of zeros is empty. */
#ifndef FRAY_WIRE_QUEUE_H
#define FRAY_WIRE_QUEUE_H

#include <stdint.h>

#include "rt/base/assert.h"
#include "rt/base/bytes.h"
#include "rt/wire/dictionary.h"

enum { QUEUE_CAPACITY = 256 }; /* a power of two */

typedef struct {
  uint8_t lane; /* the kind of message; the port numbers them */
  uint8_t keep; /* 1: queue_drop() leaves it in the queue; the reader sets it */
  uint8_t data[DICTIONARY_LENGTH];
} queue_item;

typedef struct {
  queue_item items[QUEUE_CAPACITY];
  uint32_t head; /* 0..QUEUE_CAPACITY-1 */
  uint32_t count;
} queue;

/* The n-th item from the front. n < count. Cost: constant. */
static inline queue_item *queue_at(queue *q, uint32_t n) {
  FRAY_ASSERT(q->head < QUEUE_CAPACITY && q->count <= QUEUE_CAPACITY);
  FRAY_ASSERT(n < q->count);
  return &q->items[(q->head + n) & (uint32_t)(QUEUE_CAPACITY - 1)];
}

/* Adds an item at the end and returns it, for the caller to fill; NULL iff the queue is full. Cost:
 * constant. */
static inline queue_item *queue_add(queue *q) {
  FRAY_ASSERT(q->count <= QUEUE_CAPACITY);
  if (q->count == QUEUE_CAPACITY) return 0;
  q->count += 1;
  return queue_at(q, q->count - 1);
}

/* Removes those of the first n items that have no `keep`; the order of the rest stays. n <= count.
 * Kept items move back over removed ones. Cost: linear in n, not in the queue's length. */
static inline void queue_drop(queue *q, uint32_t n) {
  FRAY_ASSERT(n <= q->count);
  uint32_t free_from = n;
  for (uint32_t at = n; at > 0; --at) {
    const queue_item *item = queue_at(q, at - 1);
    if (!item->keep) continue;
    free_from -= 1;
    if (free_from != at - 1) bytes_copy(queue_at(q, free_from), item, sizeof *item);
  }
  q->head = (q->head + free_from) & (uint32_t)(QUEUE_CAPACITY - 1);
  q->count -= free_from;
}

#endif
