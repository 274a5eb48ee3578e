/* SPDX-License-Identifier: Apache-2.0 */
/* A bounded queue of what came in and has not been looked at: 10 bytes a frame, since only
 * 8-byte messages of three kinds get this far. Not for two interrupt levels at a time. */
#ifndef FRAY_WIRE_QUEUE_H
#define FRAY_WIRE_QUEUE_H

#include <stdint.h>

#include "rt/base/bytes.h"
#include "rt/wire/dictionary.h"

enum { QUEUE_CAPACITY = 256 }; /* a power of two */

typedef struct {
  uint8_t lane;  /* what kind of message, the port's matter */
  uint8_t waits; /* set by the reader: queue_drop() leaves it in */
  uint8_t data[DICTIONARY_LENGTH];
} queue_item;

typedef struct {
  queue_item items[QUEUE_CAPACITY];
  uint32_t head; /* 0..QUEUE_CAPACITY-1 */
  uint32_t count;
} queue;

/* The n-th from the front, n < count. */
static inline queue_item *queue_at(queue *q, uint32_t n) {
  return &q->items[(q->head + n) & (uint32_t)(QUEUE_CAPACITY - 1)];
}

/* The place for one more at the end; 0 iff the queue is full. */
static inline queue_item *queue_add(queue *q) {
  if (q->count == QUEUE_CAPACITY) return 0;
  q->count += 1;
  return queue_at(q, q->count - 1);
}

/* Drops those of the first n that do not wait; what stays keeps its order. n <= count.
 * Those that stay move back over those that go, so the cost is n, not the queue's length. */
static inline void queue_drop(queue *q, uint32_t n) {
  uint32_t free_from = n;
  for (uint32_t at = n; at > 0; --at) {
    const queue_item *item = queue_at(q, at - 1);
    if (!item->waits) continue;
    free_from -= 1;
    if (free_from != at - 1) bytes_copy(queue_at(q, free_from), item, sizeof *item);
  }
  q->head = (q->head + free_from) & (uint32_t)(QUEUE_CAPACITY - 1);
  q->count -= free_from;
}

#endif
