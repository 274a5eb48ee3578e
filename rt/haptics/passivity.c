/* SPDX-License-Identifier: Apache-2.0 */
/* A pose counts in 2 um and a force in 0.5 mN, so their product is a nanojoule, and energy an exact
 * sum: the device was given force times way, where the force is the one that it held on that way
 * (`delay` ticks old).
 *
 * The cloth hands energy from one hand to the other, so only the sum of both says what was made.
 * The controller looks a tick ahead, by the speed of now: forces on their way, and those to be
 * sent. Where that gives more than the reserve, it adds what takes the rest, against the motion
 * (Ryu, Kwon and Hannaford 2004, over the energy of the ports alone). It changes forces and not the
 * coupling: clamp and rate limit come behind it. */
#include "rt/haptics/passivity.h"

#if FRAY_HANDLES

static int64_t work_of(const int32_t force[3], const int32_t moved[3]) {
  int64_t sum = 0;
  for (uint32_t n = 0; n < 3; ++n) sum += fx_mul_wide(force[n], moved[n]);
  return sum;
}

/* Saturates: a session of years counts. So does what an image says, and the sum of both hands fits. */
static int64_t count_energy(int32_t words[2], int64_t by) {
  const int64_t bound = INT64_MAX / 4;
  const int64_t before = fx_clamp64((int64_t)state_pair(words), -bound, bound);
  const int64_t sum = fx_clamp64(before + by, -bound, bound);
  state_set_pair(words, (uint64_t)sum);
  return sum;
}

/* The way of a hand in this tick; counts its work. Returns what it will have been given a tick
 * later, less the reserve. */
static int64_t meter_hand(fray_world *w, uint32_t h, const int32_t force[3], int32_t moved[3]) {
  const handle_params *k = &w->handles.constants[h];
  handle_state *s = &w->handles.states[h];
  for (uint32_t n = 0; n < 3; ++n) {
    moved[n] = w->state->hand[h].pose[n] - s->before[n];
    s->before[n] = w->state->hand[h].pose[n];
  }
  FRAY_ASSERT(k->delay >= 1 && k->delay <= HANDLE_DELAY_MAX);
  const int64_t given = count_energy(s->given, work_of(s->sent[k->delay - 1], moved));
  if (given > (int64_t)state_pair(s->most)) state_set_pair(s->most, (uint64_t)given);
  int64_t ahead = given + work_of(force, moved) - k->reserve_nj;
  for (int32_t n = 0; n < k->delay - 1; ++n) ahead += work_of(s->sent[n], moved);
  return ahead;
}

/* Rounded up in size. */
static int32_t brake_share(int64_t over, int32_t moved, int64_t squared) {
  const int64_t size =
      fx_clamp64(over, 0, (int64_t)1 << 44) * (moved < 0 ? -(int64_t)moved : moved);
  const int64_t share = fx_clamp64((size + squared - 1) / squared, 0, HANDLE_CONTROL_MAX);
  return (int32_t)(moved < 0 ? -share : share);
}

void passivity_control(fray_world *w, int32_t force[FRAY_HANDS][3]) {
  FRAY_ASSERT(world_has_handles(w));
  int32_t moved[FRAY_HANDS][3] = {{0, 0, 0}, {0, 0, 0}};
  int64_t over = 0;
  int64_t squared = 0;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    if (w->handles.constants[h].body == HANDLE_NONE) continue;
    over += meter_hand(w, h, force[h], moved[h]);
    squared += work_of(moved[h], moved[h]);
  }
  if (over <= 0 || squared == 0) return;
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    int32_t brake[3];
    for (uint32_t n = 0; n < 3; ++n) {
      brake[n] = -brake_share(over, moved[h][n], squared);
      force[h][n] = fx_saturate((int64_t)force[h][n] + brake[n]);
    }
    (void)count_energy(w->handles.states[h].taken, -work_of(brake, moved[h]));
  }
}

void passivity_remember(fray_world *w, uint32_t h, const int32_t sent[3]) {
  FRAY_ASSERT(world_has_handles(w) && h < FRAY_HANDS);
  handle_state *s = &w->handles.states[h];
  for (uint32_t n = 0; n < 3; ++n) {
    for (uint32_t k = HANDLE_DELAY_MAX - 1u; k > 0; --k) s->sent[k][n] = s->sent[k - 1u][n];
    s->sent[0][n] = sent[n];
  }
}

#endif
