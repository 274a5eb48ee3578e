/* SPDX-License-Identifier: Apache-2.0 */
/* Finds the structural springs whose strain exceeds their own threshold (Metaaphanon 2009,
 * sections 3.2 and 4.1: those still over it after all projections and collisions).
 *
 * At most cuts_max are taken in a tick: those farthest over their threshold, ties by canonical
 * number. The others wait; they are tested again in the next tick, when the cuts around them may
 * have relieved them. */
#include "rt/model/couples.h"
#include "rt/stage/cuts.h"
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

/* n / limit - 1 in Q16, for n > limit; limits are below 2^47. */
static uint32_t excess_over(uint64_t n, uint64_t limit) {
  return fx_divide_wide(n - limit, (uint32_t)(limit >> 16) + 1u);
}

/* In worlds with yarns no spring is cut before its ends have split, where they can: held ones never
 * do, nor do others once the spare particles are used up. */
__attribute__((noinline)) static int ends_have_split(const fray_world *w, uint32_t row) {
  const uint32_t held = (uint32_t)w->params->held;
  const uint32_t i = w->row_i[row];
  const uint32_t j = w->row_j[row];
  return (i < held || couple_is_light(w, i)) && (j < held || couple_is_light(w, j));
}

void tear_part(fray_world *w, uint32_t first, uint32_t end) {
  const params *p = w->params;
  if (p->tearing == 0) return;
  const link_view view = {w->x, w->y, w->z, w->row_i, w->row_j, w->row_class, w->links,
                          w->capacity[POOL_LINK_CLASSES]};
  for (uint32_t row = first; row < end; ++row) {
    row = wide_over(w->kernel, view, p->tear_min, row, end);
    if (row == end) break;
    const uint32_t kind = w->row_class[row];
    if (kind == ROW_DEAD) continue;
    const int32_t rest = w->links[kind & ROW_CLASS].rest;
    const vec3 d = vec_sub(world_position(w, w->row_j[row]), world_position(w, w->row_i[row]));
    const uint64_t n = vec_squared(d);
    if (n <= link_stretched_squared(rest, p->tear_min)) continue; /* no draw is below tear_min */
    const uint64_t limit = link_stretched_squared(rest, world_threshold(w, row));
    if (n <= limit || (world_has_yarns(w) && !ends_have_split(w, row))) continue;
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
