/* SPDX-License-Identifier: Apache-2.0 */
/* Velocities lose a share each tick (Metaaphanon 2009, section 4, step 3): `drag` of the velocity
 * itself (air), and `relative_damping` of what differs from the rigid motion of the whole sheet,
 *
 *   dv = share * (v_cm + omega x (x - x_cm) - v),  omega = I^-1 L      (Mueller et al. 2007, 3.5)
 *
 * which leaves the sheet's fall and turning alone. All particles weigh the same, so sums need no
 * weights. Pieces that have torn off count as one sheet with the rest. */
#include "rt/stage/stage.h"

typedef struct {
  vec3 centre;    /* Q24 lu */
  vec3 velocity;  /* Q28 lu per substep */
  int64_t turn[3]; /* omega, Q28 radians per substep */
} rigid_motion;

static int32_t mean(const int32_t *v, uint32_t first, uint32_t end) {
  int64_t sum = 0;
  for (uint32_t p = first; p < end; ++p) sum += v[p];
  return (int32_t)(sum / (int64_t)(end - first));
}

/* Shifts all of `v` right until the largest has at most `bits` bits; returns the shift. */
static unsigned normalise(int64_t *v, uint32_t count, unsigned bits) {
  uint64_t all = 0;
  for (uint32_t n = 0; n < count; ++n) all |= (uint64_t)(v[n] < 0 ? -v[n] : v[n]);
  unsigned shift = 0;
  while (all >> shift >= (uint64_t)1 << bits) ++shift;
  for (uint32_t n = 0; n < count && shift > 0; ++n) v[n] = fx_round64(v[n], shift);
  return shift;
}

/* omega = I^-1 L by Cramer's rule on 19-bit mantissas. i: xx yy zz xy xz yz (tensor entries, Q26);
 * l: Q29. A sheet with no extent along two axes does not turn. */
static void solve_turn(int64_t i[6], int64_t l[3], int64_t turn[3]) {
  const unsigned i_shift = normalise(i, 6, 19);
  const unsigned l_shift = normalise(l, 3, 19);
  const int64_t adjugate[6] = {i[1] * i[2] - i[5] * i[5], i[0] * i[2] - i[4] * i[4],
                               i[0] * i[1] - i[3] * i[3], i[4] * i[5] - i[3] * i[2],
                               i[3] * i[5] - i[4] * i[1], i[3] * i[4] - i[5] * i[0]};
  const int64_t determinant = i[0] * adjugate[0] + i[3] * adjugate[3] + i[4] * adjugate[4];
  const int64_t unit = determinant >> 20; /* so that the quotient is Q20 */
  for (uint32_t n = 0; n < 3; ++n) turn[n] = 0;
  if (unit <= 0) return;
  const int64_t v[3] = {adjugate[0] * l[0] + adjugate[3] * l[1] + adjugate[4] * l[2],
                        adjugate[3] * l[0] + adjugate[1] * l[1] + adjugate[5] * l[2],
                        adjugate[4] * l[0] + adjugate[5] * l[1] + adjugate[2] * l[2]};
  /* L is Q29 << -l_shift, I is Q26 << -i_shift: quotient * 2^(20 + 3 + l_shift - i_shift) */
  const int power = 28 - 23 + (int)l_shift - (int)i_shift;
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t quotient = v[n] / unit;
    turn[n] = power < 0 ? fx_round64(quotient, (unsigned)(power < -62 ? 62 : -power))
                        : fx_clamp64(quotient, -((int64_t)1 << 30), (int64_t)1 << 30) *
                              ((int64_t)1 << (power > 20 ? 20 : power));
    turn[n] = fx_clamp64(turn[n], -((int64_t)1 << 31), (int64_t)1 << 31);
  }
}

static rigid_motion find_motion(const fray_world *w, uint32_t first, uint32_t end) {
  rigid_motion m;
  int64_t inertia[6] = {0, 0, 0, 0, 0, 0};
  int64_t momentum[3] = {0, 0, 0};
  m.centre = vec_make(mean(w->x, first, end), mean(w->y, first, end), mean(w->z, first, end));
  m.velocity = vec_make(mean(w->vx, first, end), mean(w->vy, first, end), mean(w->vz, first, end));
  for (uint32_t p = first; p < end; ++p) {
    const int64_t x = fx_round64((int64_t)w->x[p] - m.centre.x, 11); /* Q13 */
    const int64_t y = fx_round64((int64_t)w->y[p] - m.centre.y, 11);
    const int64_t z = fx_round64((int64_t)w->z[p] - m.centre.z, 11);
    const int64_t u = fx_round64((int64_t)w->vx[p] - m.velocity.x, 12); /* Q16 */
    const int64_t v = fx_round64((int64_t)w->vy[p] - m.velocity.y, 12);
    const int64_t t = fx_round64((int64_t)w->vz[p] - m.velocity.z, 12);
    inertia[0] += y * y + z * z;
    inertia[1] += x * x + z * z;
    inertia[2] += x * x + y * y;
    inertia[3] -= x * y;
    inertia[4] -= x * z;
    inertia[5] -= y * z;
    momentum[0] += y * t - z * v;
    momentum[1] += z * u - x * t;
    momentum[2] += x * v - y * u;
  }
  solve_turn(inertia, momentum, m.turn);
  return m;
}

static int32_t approach(int32_t v, int64_t rigid, int32_t share) {
  const int32_t away = fx_saturate(rigid - v);
  return fx_saturate(v + fx_round64(fx_mul_wide(away, share), 24));
}

__attribute__((noinline)) static void damp_relative(fray_world *w, uint32_t first, uint32_t end) {
  const rigid_motion m = find_motion(w, first, end);
  const int32_t share = w->params->relative_damping;
  for (uint32_t p = first; p < end; ++p) {
    const int64_t x = (int64_t)w->x[p] - m.centre.x;
    const int64_t y = (int64_t)w->y[p] - m.centre.y;
    const int64_t z = (int64_t)w->z[p] - m.centre.z;
    /* products below 2^31 * 2^31 each; Q52 to Q28 */
    const int64_t turn_x = fx_round64(fx_mul64(m.turn[1], z) - fx_mul64(m.turn[2], y), 24);
    const int64_t turn_y = fx_round64(fx_mul64(m.turn[2], x) - fx_mul64(m.turn[0], z), 24);
    const int64_t turn_z = fx_round64(fx_mul64(m.turn[0], y) - fx_mul64(m.turn[1], x), 24);
    w->vx[p] = approach(w->vx[p], m.velocity.x + turn_x, share);
    w->vy[p] = approach(w->vy[p], m.velocity.y + turn_y, share);
    w->vz[p] = approach(w->vz[p], m.velocity.z + turn_z, share);
  }
}

static void drag_axis(int32_t *v, uint32_t first, uint32_t end, int32_t share) {
  for (uint32_t p = first; p < end; ++p)
    v[p] -= (int32_t)fx_round64(fx_mul_wide(v[p], share), 24);
}

void damp_run(fray_world *w) {
  const uint32_t first = (uint32_t)w->params->held;
  const uint32_t end = (uint32_t)w->params->particles;
  if (first == end) return;
  if (w->params->relative_damping != 0) damp_relative(w, first, end);
  if (w->params->drag != 0) {
    drag_axis(w->vx, first, end, w->params->drag);
    drag_axis(w->vy, first, end, w->params->drag);
    drag_axis(w->vz, first, end, w->params->drag);
  }
}
