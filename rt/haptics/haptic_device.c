/* SPDX-License-Identifier: Apache-2.0 */
/* Hands and commands: READY -> (START, every hand armed) -> OPERATIONAL -> (stale) SAFE
 * -> (RESET) READY. Then where every driven body goes in this tick: `motion.to`, which bodies_advance()
 * (integrate/bodies.c) reaches in its substeps. */
#include "rt/haptics/haptics.h"

#include "rt/haptics/handle_proxy.h"

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
    case FRAY_COMMAND_START:
      if (s->mode == FRAY_SAFE || !has_hands) return FRAY_RESULT_REFUSED;
      if (s->mode == FRAY_READY) s->starting = 1;
      s->muted = 0;
      return FRAY_RESULT_OK;
    case FRAY_COMMAND_STOP:
      s->starting = 0;
      if (s->mode == FRAY_SAFE) return FRAY_RESULT_REFUSED;
      s->mode = FRAY_READY;
      return FRAY_RESULT_OK;
    case FRAY_COMMAND_RESET:
      if (s->mode != FRAY_SAFE) return FRAY_RESULT_REFUSED;
      s->mode = FRAY_READY;
      s->faults = 0;
      return FRAY_RESULT_OK;
    case FRAY_COMMAND_ZERO:
      if (s->mode != FRAY_OPERATIONAL) return FRAY_RESULT_REFUSED;
      s->muted = 1;
      return FRAY_RESULT_OK;
    case FRAY_COMMAND_HALT:
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
    const rigid_body *k = &w->rigid.bodies[b];
    if (k->motion != FRAY_HAND) continue;
    FRAY_ASSERT(k->hand >= 0 && k->hand < FRAY_HANDS && hand_used(w, (uint32_t)k->hand));
    hand_state *hand = &w->state->hand[k->hand];
    for (uint32_t n = 0; n < 3; ++n) {
      const int64_t away = (int64_t)w->rigid.states[b].position[n] - k->start[n];
      const int64_t steps = away * 256 / w->params->pose_gain;
      hand->datum[n] = fx_clamp_wide(hand->pose[n] - steps, 1 << 17);
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
  FRAY_ASSERT(s->mode >= FRAY_READY && s->mode <= FRAY_SAFE);
  w->haptic.answered = input->command;
  w->haptic.answer_counter = input->command_counter;
  w->haptic.result = FRAY_RESULT_OK;
  if (input->command != FRAY_COMMAND_NONE)
    w->haptic.result = (uint8_t)obey(s, input->command, w->params->hands != 0);
  if (s->mode == FRAY_READY && s->starting != 0 && all_armed(w)) {
    s->mode = FRAY_OPERATIONAL;
    s->starting = 0;
    take_datum(w);
    if (world_has_handles(w)) handle_proxies_start(w);
  }
  if (s->mode == FRAY_OPERATIONAL) latch_stale(w);
}

/* Share of the force that is let out: up over ramp_ticks, down over fade_ticks. */
static void move_ramp(fray_world *w) {
  const params *p = w->params;
  state *s = w->state;
  const int up = s->mode == FRAY_OPERATIONAL && s->muted == 0;
  const int32_t ticks = up ? p->ramp_ticks : p->fade_ticks;
  FRAY_ASSERT(ticks > 0 && s->ramp >= 0 && s->ramp <= 65536);
  const int32_t step = (65536 + ticks - 1) / ticks;
  s->ramp = fx_clamp(s->ramp + (up ? step : -step), 0, 65536);
}

static vec3 follow_hand(const fray_world *w, uint32_t b) {
  const rigid_body *k = &w->rigid.bodies[b];
  FRAY_ASSERT(k->hand >= 0 && k->hand < FRAY_HANDS);
  const hand_state *hand = &w->state->hand[k->hand];
  const int32_t *at = w->rigid.states[b].position;
  int32_t to[3] = {at[0], at[1], at[2]};
  if (w->state->mode == FRAY_OPERATIONAL)
    for (uint32_t n = 0; n < 3; ++n) {
      const int64_t steps = (int64_t)hand->pose[n] - hand->datum[n];
      to[n] = haptic_toward(at[n], k->start[n] + fx_round64(steps * w->params->pose_gain, 8),
                            w->params->hand_speed);
    }
  return vec_of(to);
}

/* Straight from key to key; the position at the end of this tick. Keys are below 2^31: after that a body
 * stays. */
__attribute__((noinline)) static vec3 follow_path(const fray_world *w, const rigid_body *k) {
  const uint64_t before = state_tick(w->state);
  const uint32_t tick = before < INT32_MAX ? (uint32_t)before + 1u : INT32_MAX;
  const keyframe *keys = &w->rigid.keyframes[k->keyframe_first];
  FRAY_ASSERT(k->keyframes > 0 && (uint32_t)(k->keyframe_first + k->keyframes) <= w->capacity[POOL_KEYS]);
  uint32_t n = 0;
  while (n + 1u < (uint32_t)k->keyframes && (uint32_t)keys[n + 1u].tick <= tick) ++n;
  const keyframe *a = &keys[n];
  if (n + 1u == (uint32_t)k->keyframes || tick <= (uint32_t)a->tick)
    return vec_of(a->position);
  const keyframe *b = &keys[n + 1u];
  FRAY_ASSERT(b->tick > a->tick);
  const int64_t span = b->tick - a->tick;
  const int64_t into = (int64_t)tick - a->tick;
  int32_t at[3];
  for (uint32_t m = 0; m < 3; ++m)
    at[m] = (int32_t)(a->position[m] + ((int64_t)b->position[m] - a->position[m]) * into / span);
  return vec_of(at);
}

static void send_bodies(fray_world *w) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    const rigid_body *k = &w->rigid.bodies[b];
    body_motion *m = &w->rigid.motion[b];
    m->from = m->to = vec_of(w->rigid.states[b].position);
    if (k->motion == FRAY_HAND) m->to = follow_hand(w, b);
    if (k->motion == FRAY_PATH) m->to = follow_path(w, k);
  }
}

void haptic_device_update(fray_world *w, const fray_input *input) {
  receive_poses(w, input);
  change_state(w, input);
  move_ramp(w);
  send_bodies(w);
  if (world_has_handles(w)) handle_proxies_move(w);
}
