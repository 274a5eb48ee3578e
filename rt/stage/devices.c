/* SPDX-License-Identifier: Apache-2.0 */
/* Hands and commands: READY -> (START, every hand armed) -> OPERATIONAL -> (stale) SAFE
 * -> (RESET) READY. Then where every driven body goes in this tick. */
#include "rt/stage/stage.h"

static int hand_used(const fray_world *w, uint32_t h) {
  return ((uint32_t)w->params->hands >> h & 1u) != 0;
}

static void receive_pose(hand_state *hand, const fray_pose *pose) {
  hand->pose[0] = pose->x;
  hand->pose[1] = pose->y;
  hand->pose[2] = pose->z;
  hand->consumed = pose->counter & 15;
  hand->buttons = pose->buttons & 15;
  hand->missing = 0;
  if (hand->good < INT32_MAX) ++hand->good;
}

static void receive_poses(fray_world *w, const fray_input *input) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    hand_state *hand = &w->state->hand[h];
    if (!hand_used(w, h)) continue;
    if ((input->has_pose >> h & 1u) != 0) {
      receive_pose(hand, &input->pose[h]);
    } else {
      hand->good = 0;
      if (hand->missing < INT32_MAX) ++hand->missing;
    }
  }
}

static fray_result obey(state *s, uint32_t verb, int has_hands) {
  switch (verb) {
    case FRAY_VERB_START:
      if (s->mode == FRAY_SAFE || !has_hands) return FRAY_RESULT_REFUSED;
      if (s->mode == FRAY_READY) s->starting = 1;
      s->muted = 0;
      return FRAY_RESULT_OK;
    case FRAY_VERB_STOP:
      s->starting = 0;
      if (s->mode == FRAY_SAFE) return FRAY_RESULT_REFUSED;
      s->mode = FRAY_READY;
      return FRAY_RESULT_OK;
    case FRAY_VERB_RESET:
      if (s->mode != FRAY_SAFE) return FRAY_RESULT_REFUSED;
      s->mode = FRAY_READY;
      s->faults = 0;
      return FRAY_RESULT_OK;
    case FRAY_VERB_ZERO:
      if (s->mode != FRAY_OPERATIONAL) return FRAY_RESULT_REFUSED;
      s->muted = 1;
      return FRAY_RESULT_OK;
    case FRAY_VERB_HALT:
      s->starting = 0;
      s->mode = FRAY_SAFE;
      s->ramp = 0; /* the device has heard nothing for a while: no force comes back */
      s->faults |= (int32_t)FRAY_FAULT_HALTED;
      return FRAY_RESULT_OK;
    default:
      return FRAY_RESULT_UNKNOWN;
  }
}

static int all_armed(const fray_world *w) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    if (hand_used(w, h) && w->state->hand[h].good < w->params->arm_poses) return 0;
  return w->params->hands != 0;
}

/* The pose that means "where the body stands now": nothing jumps at START. */
__attribute__((noinline)) static void take_datum(fray_world *w) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    const body *k = &w->bodies[b];
    if (k->motion != FRAY_HAND) continue;
    hand_state *hand = &w->state->hand[k->hand];
    for (uint32_t n = 0; n < 3; ++n) {
      const int64_t away = (int64_t)w->body_states[b].position[n] - k->home[n];
      const int64_t steps = away * 256 / w->params->pose_gain;
      hand->datum[n] = (int32_t)fx_clamp64(hand->pose[n] - steps, -(1 << 17), 1 << 17);
    }
  }
}

static void latch_stale(fray_world *w) {
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    if (hand_used(w, h) && w->state->hand[h].missing >= w->params->stale_ticks) {
      w->state->mode = FRAY_SAFE;
      w->state->faults |= h == 0 ? (int32_t)FRAY_FAULT_STALE_LEFT : (int32_t)FRAY_FAULT_STALE_RIGHT;
    }
}

static void change_state(fray_world *w, const fray_input *input) {
  state *s = w->state;
  w->acked = input->verb;
  w->ack_counter = input->verb_counter;
  w->result = FRAY_RESULT_OK;
  if (input->verb != FRAY_VERB_NONE) w->result = (uint8_t)obey(s, input->verb, w->params->hands != 0);
  if (s->mode == FRAY_READY && s->starting != 0 && all_armed(w)) {
    s->mode = FRAY_OPERATIONAL;
    s->starting = 0;
    take_datum(w);
  }
  if (s->mode == FRAY_OPERATIONAL) latch_stale(w);
}

/* Share of the force that is let out: up over ramp_ticks, down over fade_ticks. */
static void move_ramp(fray_world *w) {
  const params *p = w->params;
  state *s = w->state;
  const int up = s->mode == FRAY_OPERATIONAL && s->muted == 0;
  const int32_t ticks = up ? p->ramp_ticks : p->fade_ticks;
  const int32_t step = (65536 + ticks - 1) / ticks;
  s->ramp = fx_clamp(s->ramp + (up ? step : -step), 0, 65536);
}

static int32_t toward(int32_t from, int64_t target, int32_t step_max) {
  const int64_t bounded = fx_clamp64(target, -(int64_t)FX_WORLD_MAX, FX_WORLD_MAX);
  return (int32_t)(from + fx_clamp64(bounded - from, -(int64_t)step_max, step_max));
}

static vec3 follow_hand(const fray_world *w, uint32_t b) {
  const body *k = &w->bodies[b];
  const hand_state *hand = &w->state->hand[k->hand];
  const int32_t *at = w->body_states[b].position;
  int32_t to[3] = {at[0], at[1], at[2]};
  if (w->state->mode == FRAY_OPERATIONAL)
    for (uint32_t n = 0; n < 3; ++n) {
      const int64_t steps = (int64_t)hand->pose[n] - hand->datum[n];
      to[n] = toward(at[n], k->home[n] + fx_round64(steps * w->params->pose_gain, 8),
                     w->params->hand_speed);
    }
  return vec_make(to[0], to[1], to[2]);
}

/* Straight from key to key; the position at the end of this tick. */
__attribute__((noinline)) static vec3 follow_path(const fray_world *w, const body *k) {
  const uint32_t tick = (uint32_t)w->state->tick + 1u;
  const body_key *keys = &w->keys[k->key_first];
  uint32_t n = 0;
  while (n + 1u < (uint32_t)k->keys && (uint32_t)keys[n + 1u].tick <= tick) ++n;
  const body_key *a = &keys[n];
  if (n + 1u == (uint32_t)k->keys || tick <= (uint32_t)a->tick)
    return vec_make(a->position[0], a->position[1], a->position[2]);
  const body_key *b = &keys[n + 1u];
  const int64_t span = b->tick - a->tick;
  const int64_t into = (int64_t)tick - a->tick;
  int32_t at[3];
  for (uint32_t m = 0; m < 3; ++m)
    at[m] = (int32_t)(a->position[m] + ((int64_t)b->position[m] - a->position[m]) * into / span);
  return vec_make(at[0], at[1], at[2]);
}

static void send_bodies(fray_world *w) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    const body *k = &w->bodies[b];
    const int32_t *at = w->body_states[b].position;
    body_motion *m = &w->motion[b];
    m->from = vec_make(at[0], at[1], at[2]);
    m->to = m->from;
    if (k->motion == FRAY_HAND) m->to = follow_hand(w, b);
    if (k->motion == FRAY_PATH) m->to = follow_path(w, k);
  }
}

void devices_run(fray_world *w, const fray_input *input) {
  receive_poses(w, input);
  change_state(w, input);
  move_ramp(w);
  send_bodies(w);
}
