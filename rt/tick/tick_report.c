/* SPDX-License-Identifier: Apache-2.0 */
/* Closes the tick: counts it, hashes the state, fills the output. */
#include "rt/tick/tick.h"

#include "rt/image/state_hash.h"

/* No stage has taken more from a pool than there is. */
__attribute__((unused)) static int pools_hold(const fray_world *w) {
  return particles_attached(w) <= w->p.count && w->p.count <= w->capacity[POOL_PARTICLES] &&
         w->contact.count <= w->capacity[POOL_CONTACTS] &&
         w->woven.tear_count <= (uint32_t)w->params->tears_max &&
         (!world_has_membrane(w) || triangles_in_use(w) <= w->capacity[POOL_TRIANGLES]);
}

FX_WRAPS void tick_report_begin(fray_world *w, fray_output *output) {
  FRAY_ASSERT(pools_hold(w));
  output->tick = state_tick(w->state);
  state_set_pair(w->state->tick, output->tick + 1u);
}

void tick_report_end(fray_world *w, uint64_t found, fray_output *output) {
  state *s = w->state;
  FRAY_ASSERT((s->faults & ~(int32_t)FRAY_FAULTS_ALL) == 0 && s->mode >= FRAY_READY && s->mode <= FRAY_SAFE);
  output->hash = found;
  state_set_pair(s->hash, found);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    output->consumed[h] = (uint8_t)s->hand[h].consumed;
    for (uint32_t n = 0; n < 3; ++n) output->force_unlimited[h][n] = w->haptic.force_unlimited[h][n];
  }
  output->state = (uint8_t)s->mode;
  output->answered = w->haptic.answered;
  output->answer_counter = w->haptic.answer_counter;
  output->result = w->haptic.result;
  output->faults = (uint16_t)s->faults;
  output->tears_waiting = w->woven.tears_waiting;
  output->first_tear = w->first_tear;
  output->tears_total = (uint32_t)s->tears_total;
  if (world_has_yarns(w)) {
    output->splits_waiting = (uint32_t)w->woven.yarn_counts->pending;
    output->crossings_connected = (uint32_t)w->woven.yarn_counts->connected;
    output->crossings_loose = (uint32_t)w->woven.yarn_counts->loose;
    output->crossings_disconnected = (uint32_t)w->woven.yarn_counts->disconnected;
  }
  output->work = w->work;
}

void tick_report(fray_world *w, fray_output *output) {
  tick_report_begin(w, output);
  tick_report_end(w, state_hash(w), output);
}
