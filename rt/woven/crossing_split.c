/* SPDX-License-Identifier: Apache-2.0 */
/* Splits the crossings that crossing_transition_find() marked as pending, and loosens connected ones, by
 * ascending number, at most capacity[POOL_SPLITS] a tick; the others stay pending. Once no spare particle is
 * left, crossings stay whole, and their springs do not break. */
#include "rt/state/crossing.h"
#include "rt/woven/woven.h"
#include "rt/woven/yarn_slip.h"

__attribute__((noinline)) static void split_pending(fray_world *w, uint32_t crossing) {
  FRAY_ASSERT(crossing_state_at(w, crossing) == FRAY_WHOLE ||
              crossing_state_at(w, crossing) == FRAY_CONNECTED);
  crossing_set_pending(w, crossing, 0);
  if (crossing_state_at(w, crossing) == FRAY_CONNECTED) {
    crossing_set_state(w, crossing, FRAY_LOOSE);
  } else if (crossing_split(w, crossing, FRAY_LOOSE)) {
    yarn_slip_begin(w, crossing_contact(w, crossing));
  } else {
    world_fault(w, FRAY_FAULT_PARTICLES_FULL);
    return;
  }
  ++w->work.splits;
}

void crossing_split_apply(fray_world *w) {
  FRAY_ASSERT(world_has_yarns(w));
  FRAY_ASSERT(w->woven.yarn_counts->pending >= 0);
  if (w->woven.yarn_counts->pending == 0 || w->params->tearing == 0) return;
  uint32_t left = w->capacity[POOL_SPLITS];
  for (uint32_t c = 0; c < w->capacity[POOL_CROSSINGS] && w->woven.yarn_counts->pending != 0; ++c) {
    if ((w->woven.crossing_state[c] & CROSSING_PENDING) == 0) continue;
    if (left == 0) {
      world_fault(w, FRAY_FAULT_SPLIT_BUDGET);
      return;
    }
    --left;
    split_pending(w, c);
  }
}
