/* SPDX-License-Identifier: Apache-2.0 */
/* Worlds as old as a test wants. */
#ifndef FRAY_TESTS_LIB_SET_TICK_H
#define FRAY_TESTS_LIB_SET_TICK_H

#include "rt/image/state_hash.h"

/* The hash of all else in the state. */
static inline uint64_t hash_without_tick(fray_world *w) {
  const uint64_t tick = state_tick(w->state);
  state_set_pair(w->state->tick, 0);
  const uint64_t found = state_hash(w);
  state_set_pair(w->state->tick, tick);
  return found;
}

static inline void set_tick(fray_world *w, uint64_t tick) {
  state_set_pair(w->state->tick, tick);
  state_set_pair(w->state->hash, state_hash(w));
}

#endif
