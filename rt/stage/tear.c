/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the structural springs whose strain exceeds their own threshold (Metaaphanon 2009,
 * sections 3.2 and 4.1: those still over it after all projections and collisions).
 *
 * At most cuts_max are taken in a tick: those farthest over their threshold, ties by canonical
 * number. The others wait; they are tested again in the next tick, when the cuts around them may
 * have relieved them. */
#include "rt/stage/cuts.h"
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

/* (rest * (1 + strain))^2, Q48 lu^2. A rest length is below 1/8 lu, a strain at most 4. */
static uint64_t stretched_squared(int32_t rest, int32_t strain_q16) {
  const uint32_t length =
      (uint32_t)(fx_mul_wide_u((uint32_t)rest, 65536u + (uint32_t)strain_q16) >> 16);
  return fx_mul_wide_u(length, length);
}

/* n / limit - 1 in Q16, for n > limit; limits are below 2^47. */
static uint32_t excess_over(uint64_t n, uint64_t limit) {
  return fx_divide_wide(n - limit, (uint32_t)(limit >> 16) + 1u);
}

void tear_part(fray_world *w, uint32_t first, uint32_t end) {
  const params *p = w->params;
  if (p->tearing == 0) return;
  const link_view view = {w->x, w->y, w->z, w->row_i, w->row_j, w->row_class, w->links};
  for (uint32_t row = first; row < end; ++row) {
    row = wide_over(w->kernel, view, p->tear_min, row, end);
    if (row == end) break;
    const uint32_t kind = w->row_class[row];
    if (kind == ROW_DEAD) continue;
    const int32_t rest = w->links[kind].rest;
    const vec3 d = vec_sub(world_position(w, w->row_j[row]), world_position(w, w->row_i[row]));
    const uint64_t n = vec_squared(d);
    if (n <= stretched_squared(rest, p->tear_min)) continue; /* no draw is below tear_min */
    const uint64_t limit = stretched_squared(rest, world_threshold(w, row));
    if (n <= limit) continue;
    const cut found = {row, excess_over(n, limit)};
    cuts_enlist(w, found);
  }
  w->work.tear_tests += end - first;
  w->work.over += w->cut_count + w->cuts_waiting;
}

void tear_run(fray_world *w) { tear_part(w, 0, (uint32_t)w->params->links); }

uint32_t tear_worst(const fray_world *w) {
  uint32_t worst = 0;
  for (uint32_t n = 1; n < w->cut_count; ++n)
    if (cuts_worse(w, &w->cuts[n], &w->cuts[worst])) worst = n;
  return w->home[w->cuts[worst].row];
}
