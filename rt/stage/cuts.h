/* SPDX-License-Identifier: Apache-2.0 */
/* The springs to cut: a heap with the least of them first, so that a tick in which everything tears
 * costs a few steps more a spring and not cuts_max. Which springs are in it at the end does not depend
 * on the order in which they came. */
#ifndef FRAY_STAGE_CUTS_H
#define FRAY_STAGE_CUTS_H

#include "rt/model/world.h"

static inline int cuts_worse(const fray_world *w, const cut *a, const cut *b) {
  if (a->excess != b->excess) return a->excess > b->excess;
  return w->home[a->row] < w->home[b->row];
}

/* A place at the end that `found` may take, or one nearer to the top. */
static inline void cuts_rise(fray_world *w, uint32_t end, cut found) {
  uint32_t place = end;
  while (place > 0) {
    const uint32_t above = (place - 1u) / 2u;
    if (!cuts_worse(w, &w->cuts[above], &found)) break;
    w->cuts[place] = w->cuts[above];
    place = above;
  }
  w->cuts[place] = found;
}

/* From the top: below `found` only worse ones. */
static inline void cuts_sink(fray_world *w, cut found) {
  uint32_t place = 0;
  uint32_t below = 1;
  while (below + 1u < w->cut_count) {
    below += cuts_worse(w, &w->cuts[below], &w->cuts[below + 1u]) ? 1u : 0u;
    if (!cuts_worse(w, &found, &w->cuts[below])) break;
    w->cuts[place] = w->cuts[below];
    place = below;
    below = 2u * place + 1u;
  }
  if (below + 1u == w->cut_count && cuts_worse(w, &found, &w->cuts[below])) {
    w->cuts[place] = w->cuts[below];
    place = below;
  }
  w->cuts[place] = found;
}

static inline void cuts_enlist(fray_world *w, cut found) {
  if (w->cut_count < (uint32_t)w->params->cuts_max) {
    cuts_rise(w, w->cut_count++, found);
    return;
  }
  ++w->cuts_waiting;
  if (cuts_worse(w, &found, &w->cuts[0])) cuts_sink(w, found);
}

#endif
