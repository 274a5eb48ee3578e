/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts the springs that tear found, and releases the bend and shear springs that no longer make
 * sense without them (model/weave.h says which, and why). */
#include "rt/stage/stage.h"

static void cut_row(fray_world *w, uint32_t row) {
  uint32_t released[WEAVE_RELEASED];
  const uint32_t count = weave_released(world_weave(w), w->home[row], released);
  world_kill_row(w, row);
  const uint32_t shadows_from = (uint32_t)(w->params->links + w->params->bends);
  for (uint32_t n = 0; n < count; ++n) {
    world_kill_row(w, w->row_of[released[n]]);
    if (world_has_yarns(w) && released[n] >= shadows_from)
      world_kill_row(w, w->row_of[released[n] + (uint32_t)w->params->shears]);
  }
}

void cut_run(fray_world *w) {
  for (uint32_t n = 0; n < w->cut_count; ++n) cut_row(w, w->cuts[n].row);
  if (w->cut_count != 0) w->cut_first = tear_worst(w);
  w->state->cuts_total += (int32_t)w->cut_count;
  if (w->cuts_waiting != 0) w->state->faults |= (int32_t)FRAY_FAULT_CUTS_WAIT;
  w->work.cuts += w->cut_count;
}
