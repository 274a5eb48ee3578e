/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the structural springs whose strain exceeds their own threshold (Metaaphanon 2009,
 * sections 3.2 and 4.1: those still over it after all projections and collisions).
 *
 * At most cuts_max are taken in a tick: those farthest over their threshold, ties by canonical
 * number. The others wait; they are tested again in the next tick, when the cuts around them may
 * have relieved them. */
#include "rt/stage/stage.h"

/* (rest * (1 + strain))^2, Q48 lu^2. A rest length is below 1/8 lu, a strain at most 4. */
static uint64_t stretched_squared(int32_t rest, int32_t strain_q16) {
  const uint32_t length =
      (uint32_t)(fx_mul_wide_u((uint32_t)rest, 65536u + (uint32_t)strain_q16) >> 16);
  return fx_mul_wide_u(length, length);
}

/* n / limit - 1 in Q16, for n > limit. */
static uint32_t excess_over(uint64_t n, uint64_t limit) {
  const uint64_t unit = (limit >> 16) + 1u;
  const uint64_t excess = (n - limit) / unit;
  return excess > UINT32_MAX ? UINT32_MAX : (uint32_t)excess;
}

static int worse(const fray_world *w, const cut *a, const cut *b) {
  if (a->excess != b->excess) return a->excess > b->excess;
  return w->home[a->row] < w->home[b->row];
}

/* Keeps the worst cuts_max in order. */
static void enlist(fray_world *w, cut found) {
  uint32_t place = w->cut_count;
  if (place == (uint32_t)w->params->cuts_max) {
    ++w->cuts_waiting;
    if (!worse(w, &found, &w->cuts[place - 1u])) return;
    --place;
  } else {
    ++w->cut_count;
  }
  for (; place > 0 && worse(w, &found, &w->cuts[place - 1u]); --place)
    w->cuts[place] = w->cuts[place - 1u];
  w->cuts[place] = found;
}

void tear_run(fray_world *w) {
  const params *p = w->params;
  if (p->tearing == 0) return;
  for (uint32_t row = 0; row < (uint32_t)p->links; ++row) {
    const uint32_t kind = w->row_class[row];
    if (kind == ROW_DEAD) continue;
    const int32_t rest = w->links[kind].rest;
    const vec3 d = vec_sub(world_position(w, w->row_j[row]), world_position(w, w->row_i[row]));
    const uint64_t n = vec_squared(d);
    if (n <= stretched_squared(rest, p->tear_min)) continue; /* no draw is below tear_min */
    const uint64_t limit = stretched_squared(rest, world_threshold(w, row));
    if (n <= limit) continue;
    const cut found = {row, excess_over(n, limit)};
    enlist(w, found);
  }
  w->work.tear_tests += (uint32_t)p->links;
}
