/* SPDX-License-Identifier: Apache-2.0 */
/* Splits the crossings that transition marked, and loosens connected ones, in the order of their
 * numbers, at most so many a tick as the image says; the others wait. Where no spare particle is
 * left, crossings stay whole, and their springs with them. */
#include "rt/model/couples.h"
#include "rt/stage/stage.h"

__attribute__((noinline)) static void take(fray_world *w, uint32_t crossing) {
  couple_want(w, crossing, 0);
  if (couple_at(w, crossing) == FRAY_CONNECTED) {
    couple_change(w, crossing, FRAY_LOOSE);
  } else if (!couple_split(w, crossing, FRAY_LOOSE)) {
    w->state->faults |= (int32_t)FRAY_FAULT_SPARES_FULL;
    return;
  }
  ++w->work.splits;
}

void split_run(fray_world *w) {
  if (!world_has_yarns(w) || w->yarn_state->wanted == 0 || w->params->tearing == 0) return;
  uint32_t left = w->capacity[POOL_SPLITS];
  for (uint32_t c = 0; c < w->capacity[POOL_CROSSINGS] && w->yarn_state->wanted != 0; ++c) {
    if ((w->couple[c] & COUPLE_WANTED) == 0) continue;
    if (left == 0) {
      w->state->faults |= (int32_t)FRAY_FAULT_SPLITS_WAIT;
      return;
    }
    --left;
    take(w, c);
  }
}
