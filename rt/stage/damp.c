/* SPDX-License-Identifier: Apache-2.0 */
/* Velocities lose a share each tick (Metaaphanon 2009, section 4, step 3): `drag` of the velocity
 * itself (air), and `relative_damping` of what differs from the rigid motion of the whole sheet,
 *
 *   dv = share * (v_cm + omega x (x - x_cm) - v),  omega = I^-1 L      (Mueller et al. 2007, 3.5)
 *
 * which leaves the sheet's fall and turning alone. Pieces that have torn off count as one sheet with
 * the rest. Sums are without weights as long as all particles weigh the same, before any has split. */
#include "rt/base/bytes.h"
#include "rt/model/couples.h"
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

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

/* Twice a particle's mass. */
static int32_t weight(const fray_world *w, uint32_t p) { return couple_is_light(w, p) ? 1 : 2; }

__attribute__((noinline)) static int32_t weighed_mean(const fray_world *w, const int32_t *v,
                                                      uint32_t first, uint32_t end) {
  int64_t sum = 0;
  int64_t mass = 0;
  for (uint32_t p = first; p < end; ++p) {
    sum += (int64_t)v[p] * weight(w, p);
    mass += weight(w, p);
  }
  return mass > 0 ? (int32_t)(sum / mass) : 0;
}

/* Positions to Q13, velocities to Q16. */
__attribute__((noinline)) static int32_t away(int32_t v, int32_t from, unsigned down) {
  return (int32_t)fx_round64((int64_t)v - from, down);
}

/* sweep_turning() of a sheet some of whose crossings have split. */
__attribute__((noinline)) static void weighed_turning(const fray_world *w, sweep_motion *m,
                                                      uint32_t first, uint32_t end) {
  const vec3 c = vec_make(weighed_mean(w, w->x, first, end), weighed_mean(w, w->y, first, end),
                          weighed_mean(w, w->z, first, end));
  const vec3 g = vec_make(weighed_mean(w, w->vx, first, end), weighed_mean(w, w->vy, first, end),
                          weighed_mean(w, w->vz, first, end));
  bytes_zero(m, sizeof *m);
  m->centre = c;
  m->velocity = g;
  for (uint32_t p = first; p < end; ++p) {
    const int32_t at[3] = {away(w->x[p], c.x, 11), away(w->y[p], c.y, 11), away(w->z[p], c.z, 11)};
    const int32_t speed[3] = {away(w->vx[p], g.x, 12), away(w->vy[p], g.y, 12),
                              away(w->vz[p], g.z, 12)};
    const int32_t mass = weight(w, p);
    for (uint32_t n = 0; n < 3; ++n) {
      const uint32_t k = (n + 1u) % 3u;
      const uint32_t l = (n + 2u) % 3u;
      m->inertia[n] += (fx_mul_wide(at[k], at[k]) + fx_mul_wide(at[l], at[l])) * mass;
      m->inertia[5u - n] -= fx_mul_wide(at[k], at[l]) * mass; /* 3 xy, 4 xz, 5 yz */
      m->momentum[n] += (fx_mul_wide(at[k], speed[l]) - fx_mul_wide(at[l], speed[k])) * mass;
    }
  }
}

__attribute__((noinline)) static void damp_relative(fray_world *w, uint32_t first, uint32_t end) {
  sweep_motion m;
  if (end == (uint32_t)w->params->particles)
    wide_turning(w->kernel, &m, w->x, w->y, w->z, w->vx, w->vy, w->vz, first, end);
  else
    weighed_turning(w, &m, first, end);
  solve_turn(m.inertia, m.momentum, m.turn);
  wide_follow(w->kernel, &m, w->params->relative_damping, w->x, w->y, w->z, w->vx, w->vy, w->vz,
              first, end);
}

void damp_whole(fray_world *w) {
  const uint32_t first = (uint32_t)w->params->held;
  const uint32_t end = w->particles;
  if (first != end && w->params->relative_damping != 0) damp_relative(w, first, end);
}

void damp_part(fray_world *w, uint32_t first, uint32_t end) {
  const int32_t drag = w->params->drag;
  if (drag == 0) return;
  wide_drag(w->kernel, w->vx, first, end, drag);
  wide_drag(w->kernel, w->vy, first, end, drag);
  wide_drag(w->kernel, w->vz, first, end, drag);
}

void damp_run(fray_world *w) {
  if (world_has_sheet(w)) return; /* stage/pull.c */
  damp_whole(w);
  damp_part(w, (uint32_t)w->params->held, w->particles);
}
