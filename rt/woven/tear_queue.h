/* SPDX-License-Identifier: Apache-2.0 */
/* The springs to break in a tick: those farthest over their tear strain, at most tears_max, in a bounded
 * heap. Its root is the least urgent entry, which a more urgent spring replaces; so a tick in which
 * everything tears costs log(tears_max) steps a spring. The entries do not depend on the order in which
 * springs were pushed. */
#ifndef FRAY_WOVEN_TEAR_QUEUE_H
#define FRAY_WOVEN_TEAR_QUEUE_H

#include "rt/state/world.h"

/* 1 iff a is more urgent than b: farther over its strain, or as far with a lower canonical id. */
static inline int tear_queue_before(const fray_world *w, const torn_spring *a, const torn_spring *b) {
  if (a->excess != b->excess) return a->excess > b->excess;
  return w->woven.canonical_id[a->spring] < w->woven.canonical_id[b->spring];
}

/* 1 iff the queue is within its capacity and no entry is more urgent than one below it. Cost: linear. */
static inline int tear_queue_is_heap(const fray_world *w) {
  const torn_spring *heap = w->woven.tear_queue;
  if (w->woven.tear_count > (uint32_t)w->params->tears_max) return 0;
  for (uint32_t n = 1; n < w->woven.tear_count; ++n)
    if (tear_queue_before(w, &heap[(n - 1u) / 2u], &heap[n])) return 0;
  return 1;
}

/* Inserts `found` into the free entry `end`, or moves entries down on its way to the root. */
static inline void tear_queue_up(fray_world *w, uint32_t end, torn_spring found) {
  FRAY_ASSERT(end < (uint32_t)w->params->tears_max);
  uint32_t hole = end;
  while (hole > 0) {
    const uint32_t parent = (hole - 1u) / 2u;
    if (!tear_queue_before(w, &w->woven.tear_queue[parent], &found)) break;
    w->woven.tear_queue[hole] = w->woven.tear_queue[parent];
    hole = parent;
  }
  w->woven.tear_queue[hole] = found;
}

/* Replaces the root by `found`, moving less urgent entries up. */
static inline void tear_queue_down(fray_world *w, torn_spring found) {
  FRAY_ASSERT(w->woven.tear_count == (uint32_t)w->params->tears_max);
  uint32_t hole = 0;
  uint32_t child = 1;
  while (child + 1u < w->woven.tear_count) {
    child += tear_queue_before(w, &w->woven.tear_queue[child], &w->woven.tear_queue[child + 1u]) ? 1u : 0u;
    if (!tear_queue_before(w, &found, &w->woven.tear_queue[child])) break;
    w->woven.tear_queue[hole] = w->woven.tear_queue[child];
    hole = child;
    child = 2u * hole + 1u;
  }
  if (child + 1u == w->woven.tear_count && tear_queue_before(w, &found, &w->woven.tear_queue[child])) {
    w->woven.tear_queue[hole] = w->woven.tear_queue[child];
    hole = child;
  }
  w->woven.tear_queue[hole] = found;
}

/* Adds a link, or drops the least urgent of all and counts it in tears_waiting. */
static inline void tear_queue_push(fray_world *w, torn_spring found) {
  FRAY_ASSERT(found.spring < (uint32_t)w->params->links);
  FRAY_ASSERT(w->woven.tear_count <= (uint32_t)w->params->tears_max);
  if (w->woven.tear_count < (uint32_t)w->params->tears_max) {
    tear_queue_up(w, w->woven.tear_count++, found);
    return;
  }
  ++w->woven.tears_waiting;
  if (tear_queue_before(w, &found, &w->woven.tear_queue[0])) tear_queue_down(w, found);
}

#endif
