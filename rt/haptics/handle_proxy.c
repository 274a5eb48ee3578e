/* SPDX-License-Identifier: Apache-2.0 */
/* The haptic coupling of the paper of 2017 (section VI): the proxy follows the device, and what is
 * rendered is the force of spring and damper between it and the handle, their impulse of a tick
 * over the tick:
 *
 *   proxy = anchor + turn^T (pose + delay speed - datum) gain
 *   force = - force_scale turn impulse / T
 *
 * turn: rows are the device's axes in the scene. The force of a tick acts on a device that has
 * moved on for `delay` ticks, so a spring alone gives it energy (k v^2 delay T / 2 a tick). So the
 * proxy is where the device will be then, by the speed of now; at rest it is where the device is.
 */
#include "rt/haptics/handle_proxy.h"

#include "rt/haptics/haptics.h"

#if FRAY_HANDLES

static int has_handle(const fray_world *w, uint32_t h) {
  return w->handles.constants[h].body != HANDLE_NONE;
}

static void start_proxy(fray_world *w, uint32_t h) {
  const handle_params *k = &w->handles.constants[h];
  handle_state *s = &w->handles.states[h];
  hand_state *hand = &w->state->hand[h];
  for (uint32_t n = 0; n < 3; ++n) {
    hand->datum[n] = k->placed != 0 ? 0 : hand->pose[n];
    s->anchor[n] = k->placed != 0 ? k->origin[n] : s->proxy[n];
    s->before[n] = hand->pose[n];
    s->speed[n] = 0;
  }
  for (uint32_t n = 0; n < 2; ++n) s->given[n] = s->most[n] = s->taken[n] = 0;
}

void handle_proxies_start(fray_world *w) {
  FRAY_ASSERT(world_has_handles(w));
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    if (has_handle(w, h)) start_proxy(w, h);
}

/* The way from the anchor, Q24 lu, along an axis of the scene: poses to 2^18 and a lead to 2^18
 * steps, with 12 bits below, and their sum along an axis. */
static int64_t way_from_anchor(const fray_world *w, uint32_t h, uint32_t n) {
  enum { LEAD_BITS = 12 };
  const handle_params *k = &w->handles.constants[h];
  const handle_state *s = &w->handles.states[h];
  const hand_state *hand = &w->state->hand[h];
  int64_t sum = 0;
  for (uint32_t a = 0; a < 3; ++a) {
    const int32_t ahead = s->speed[a] * k->delay * (1 << (LEAD_BITS - HANDLE_SPEED_BITS));
    sum += fx_mul_wide((hand->pose[a] - hand->datum[a]) * (1 << LEAD_BITS) + ahead,
                       k->turn[3 * a + n]);
  }
  return fx_round64(fx_mul_wide(fx_saturate(fx_round64(sum, 30)), k->pose_gain), 8 + LEAD_BITS);
}

/* Half of what the speed of this tick differs by: a step of the device counts as half of one. */
static void follow_speed(fray_world *w, uint32_t h) {
  enum { SPEED_MAX = 1 << 10 }; /* steps a tick: 2 m/s at 1 kHz */
  handle_state *s = &w->handles.states[h];
  for (uint32_t n = 0; n < 3; ++n) {
    const int32_t moved = fx_clamp(w->state->hand[h].pose[n] - s->before[n], -SPEED_MAX, SPEED_MAX);
    s->speed[n] += fx_asr(moved * (1 << HANDLE_SPEED_BITS) - s->speed[n], 1);
  }
}

static void move_proxy(fray_world *w, uint32_t h) {
  handle_state *s = &w->handles.states[h];
  handle_motion *m = &w->handles.motion[h];
  const int moves = w->state->mode == FRAY_OPERATIONAL;
  follow_speed(w, h);
  for (uint32_t n = 0; n < 3; ++n) {
    m->from[n] = s->proxy[n];
    if (moves)
      s->proxy[n] = haptic_toward(s->proxy[n], s->anchor[n] + way_from_anchor(w, h, n),
                                  w->params->hand_speed);
    m->to[n] = s->proxy[n];
    m->at[n] = (int64_t)m->from[n] * (1 << FX_SUB_BITS);
  }
}

void handle_proxies_move(fray_world *w) {
  FRAY_ASSERT(world_has_handles(w));
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    if (has_handle(w, h)) move_proxy(w, h);
}

static int32_t coupling_force(const params *p, int64_t impulse) {
  enum { LESS = 8 }; /* far below a step of the force, but where a unit of impulse is many */
  const int64_t bound = (int64_t)1 << 38;
  unsigned shift = (unsigned)p->force_shift;
  FRAY_ASSERT(shift > 0 && shift < 63);
  if (shift > LESS) {
    impulse = fx_round64(impulse, LESS);
    shift -= LESS;
  }
  return fx_saturate(-fx_round64(fx_mul64(fx_clamp64(impulse, -bound, bound), p->force_gain), shift));
}

void handle_forces_find(fray_world *w) {
  FRAY_ASSERT(world_has_handles(w));
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    const handle_params *k = &w->handles.constants[h];
    if (!has_handle(w, h)) continue;
    int32_t force[3];
    for (uint32_t n = 0; n < 3; ++n)
      force[n] = coupling_force(w->params, w->handles.motion[h].impulse[n]);
    for (uint32_t a = 0; a < 3; ++a) {
      int64_t sum = 0;
      for (uint32_t n = 0; n < 3; ++n)
        sum += fx_round64(fx_mul_wide(k->turn[3 * a + n], force[n]), 14);
      w->haptic.force_unlimited[h][a] = fx_saturate(
          fx_round64(fx_mul_wide(fx_saturate(fx_round64(sum, 16)), k->force_scale), 16));
    }
  }
}

#endif
