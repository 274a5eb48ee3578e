/* SPDX-License-Identifier: Apache-2.0 */
/* The force on a hand is momentum. In a tick the free cloth gains from the particles that a body
 * grips, and from contacts with it, the impulse J = sum of m dv; by Newton's third law the body
 * feels -J / T for the tick T. `impulse` holds sum dv in Q28 lu per substep (all particles weigh
 * the same), so with n substeps a tick at rate F
 *
 *   force [0.5 mN] = -impulse * 2^-28 * m[g] * lu[cm] * (n F) * F / 50 = -impulse * gain / 2^shift
 *
 * The gripped particles' own weight and inertia are the body's, not the cloth's, and not in it.
 *
 * What is sent is a separate last stage that trusts nothing above it: ramp, clamp, rate limit.
 * Where the ramp is zero the force is zero at once: in a fade, zero in time wins over the rate. */
#include "rt/base/bytes.h"
#include "rt/haptics/handle_proxy.h"
#include "rt/haptics/haptics.h"
#include "rt/haptics/passivity.h"

static int32_t raw_force(const params *p, int64_t impulse) {
  const int64_t bound = (int64_t)1 << 38;
  FRAY_ASSERT(p->force_shift > 0 && p->force_shift < 63);
  const int64_t product = fx_mul64(fx_clamp64(impulse, -bound, bound), p->force_gain);
  return fx_saturate(-fx_round64(product, (unsigned)p->force_shift));
}

static int32_t limited(const params *p, int32_t let_out, int32_t ramp, int32_t sent) {
  FRAY_ASSERT(ramp >= 0 && ramp <= 65536);
  FRAY_ASSERT(p->force_clamp >= 0 && p->force_clamp <= INT16_MAX && p->force_rate > 0);
  if (ramp == 0) return 0;
  const int32_t clamped = fx_clamp(let_out, -p->force_clamp, p->force_clamp);
  const int32_t near = fx_clamp(clamped, sent - p->force_rate, sent + p->force_rate);
  return fx_clamp(near, -p->force_clamp, p->force_clamp);
}

void haptic_force_update(fray_world *w, int16_t force[FRAY_HANDS][3]) {
  const params *p = w->params;
  bytes_zero(w->haptic.force_unlimited, sizeof w->haptic.force_unlimited);
  for (uint32_t b = 0; b < (uint32_t)p->bodies; ++b)
    if (w->rigid.bodies[b].motion == FRAY_HAND)
      for (uint32_t n = 0; n < 3; ++n)
        w->haptic.force_unlimited[w->rigid.bodies[b].hand][n] = raw_force(p, w->rigid.motion[b].impulse[n]);
  if (world_has_handles(w)) handle_forces_find(w);
  int32_t let_out[FRAY_HANDS][3];
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    for (uint32_t n = 0; n < 3; ++n)
      let_out[h][n] = fx_mul_round(w->haptic.force_unlimited[h][n], w->state->ramp, 16);
  if (world_has_handles(w)) passivity_control(w, let_out);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    int32_t *sent = w->state->hand[h].sent;
    for (uint32_t n = 0; n < 3; ++n) {
      sent[n] = limited(p, let_out[h][n], w->state->ramp, sent[n]);
      force[h][n] = (int16_t)sent[n];
    }
    if (world_has_handles(w)) passivity_remember(w, h, sent);
  }
}
