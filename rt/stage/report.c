/* SPDX-License-Identifier: Apache-2.0 */
/* Closes the tick: counts it, hashes the state, fills the output. */
#include "rt/stage/stage.h"

void report_begin(fray_world *w, fray_output *output) {
  output->tick = (uint32_t)w->state->tick;
  w->state->tick = fx_wrap_add(w->state->tick, 1);
}

void report_end(fray_world *w, uint64_t found, fray_output *output) {
  state *s = w->state;
  output->hash = found;
  s->hash[0] = (int32_t)(uint32_t)(output->hash & 0xFFFFFFFFu);
  s->hash[1] = (int32_t)(uint32_t)(output->hash >> 32);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    output->consumed[h] = (uint8_t)s->hand[h].consumed;
    for (uint32_t n = 0; n < 3; ++n) output->raw[h][n] = w->raw_force[h][n];
  }
  output->state = (uint8_t)s->mode;
  output->acked = w->acked;
  output->ack_counter = w->ack_counter;
  output->result = w->result;
  output->faults = (uint16_t)s->faults;
  output->cuts_waiting = w->cuts_waiting;
  output->cut_first = w->cut_first;
  output->cuts_total = (uint32_t)s->cuts_total;
  if (world_has_yarns(w)) {
    output->splits_waiting = (uint32_t)w->yarn_state->wanted;
    output->couples_connected = (uint32_t)w->yarn_state->connected;
    output->couples_loose = (uint32_t)w->yarn_state->loose;
    output->couples_disconnected = (uint32_t)w->yarn_state->disconnected;
  }
  output->work = w->work;
}

void report_run(fray_world *w, fray_output *output) {
  report_begin(w, output);
  report_end(w, world_hash(w), output);
}
