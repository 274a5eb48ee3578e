/* SPDX-License-Identifier: Apache-2.0 */
/* Breaks the queued springs. Each releases at most six others: the bend springs of its yarn that span the
 * break, and both diagonals of the cells beside it (state/yarn_grid.h says why); with yarns, the second
 * spring of each diagonal too. */
#include "rt/woven/tear_queue.h"
#include "rt/woven/woven.h"

static void break_spring(fray_world *w, uint32_t spring) {
  FRAY_ASSERT(spring < (uint32_t)w->params->links && w->woven.spring_kind[spring] != SPRING_DEAD);
  uint32_t released[YARN_GRID_RELEASED];
  const uint32_t count = yarn_grid_released(world_yarn_grid(w), w->woven.canonical_id[spring], released);
  world_kill_spring(w, spring);
  const uint32_t first_shear = (uint32_t)(w->params->links + w->params->bends);
  for (uint32_t n = 0; n < count; ++n) {
    world_kill_spring(w, w->woven.spring_of[released[n]]);
    if (world_has_yarns(w) && released[n] >= first_shear) /* and the diagonal's second spring */
      world_kill_spring(w, w->woven.spring_of[released[n] + (uint32_t)w->params->shears]);
  }
}

void spring_break_apply(fray_world *w) {
  FRAY_ASSERT(!world_has_membrane(w));
  FRAY_ASSERT(tear_queue_is_heap(w));
  for (uint32_t n = 0; n < w->woven.tear_count; ++n) break_spring(w, w->woven.tear_queue[n].spring);
  if (w->woven.tear_count != 0) w->first_tear = spring_tear_worst(w);
  world_count_tears(w, w->woven.tear_count);
  if (w->woven.tears_waiting != 0) world_fault(w, FRAY_FAULT_BREAK_BUDGET);
  w->work.tears += w->woven.tear_count;
}
