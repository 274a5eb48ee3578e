/* SPDX-License-Identifier: Apache-2.0 */
/* SIMD twins: loop_mean, loop_rotation, loop_follow and loop_drag in rt/simd/particle_loops.h.
 *
 * Each tick a fraction of the velocities is removed (Metaaphanon 2009, section 4, step 3): `drag` of the
 * velocity itself (air), and `relative_damping` of its difference to the cloth's rigid motion,
 *
 *   dv = fraction * (v_cm + omega x (x - x_cm) - v),  omega = I^-1 L      (Mueller et al. 2007, 3.5)
 *
 * which leaves the fall and the rotation of the cloth alone. All pieces of a torn cloth count as one body.
 * Until the first crossing splits all particles have the same mass, and the sums need no weights. */
#include "rt/base/bytes.h"
#include "rt/energy/energy.h"
#include "rt/simd/simd.h"
#include "rt/state/crossing.h"
#include "rt/woven/woven.h"

/* Shifts all of `v` right until the largest has at most `bits` bits; returns the shift. */
static unsigned normalise(int64_t *v, uint32_t count, unsigned bits) {
  uint64_t all = 0;
  for (uint32_t n = 0; n < count; ++n) all |= (uint64_t)(v[n] < 0 ? -v[n] : v[n]);
  unsigned shift = 0;
  while (all >> shift >= (uint64_t)1 << bits) ++shift;
  for (uint32_t n = 0; n < count && shift > 0; ++n) v[n] = fx_round64(v[n], shift);
  return shift;
}

/* omega = I^-1 L by Cramer's rule on 19-bit mantissas. inertia: xx yy zz xy xz yz (tensor entries, Q26);
 * momentum: Q29. A cloth without extent along two axes does not rotate. */
static void angular_velocity(int64_t inertia[6], int64_t momentum[3], int64_t omega[3]) {
  const unsigned inertia_shift = normalise(inertia, 6, 19);
  const unsigned momentum_shift = normalise(momentum, 3, 19);
  const int64_t *const i = inertia;
  const int64_t *const l = momentum;
  const int64_t adjugate[6] = {i[1] * i[2] - i[5] * i[5], i[0] * i[2] - i[4] * i[4],
                               i[0] * i[1] - i[3] * i[3], i[4] * i[5] - i[3] * i[2],
                               i[3] * i[5] - i[4] * i[1], i[3] * i[4] - i[5] * i[0]};
  const int64_t determinant = i[0] * adjugate[0] + i[3] * adjugate[3] + i[4] * adjugate[4];
  const int64_t divisor = determinant >> 20; /* so that the quotient is Q20 */
  for (uint32_t n = 0; n < 3; ++n) omega[n] = 0;
  if (divisor <= 0) return;
  const int64_t v[3] = {adjugate[0] * l[0] + adjugate[3] * l[1] + adjugate[4] * l[2],
                        adjugate[3] * l[0] + adjugate[1] * l[1] + adjugate[5] * l[2],
                        adjugate[4] * l[0] + adjugate[5] * l[1] + adjugate[2] * l[2]};
  /* L is Q29 << -momentum_shift, I is Q26 << -inertia_shift: quotient * 2^(20 + 3 + their difference) */
  const int power = 28 - 23 + (int)momentum_shift - (int)inertia_shift;
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t quotient = v[n] / divisor;
    omega[n] = power < 0 ? fx_round64(quotient, (unsigned)(power < -62 ? 62 : -power))
                         : fx_clamp64(quotient, -((int64_t)1 << 30), (int64_t)1 << 30) *
                               ((int64_t)1 << (power > 20 ? 20 : power));
    omega[n] = fx_clamp64(omega[n], -((int64_t)1 << 31), (int64_t)1 << 31);
  }
}

/* The mean of v, weighted by mass; 0 of no particles. */
__attribute__((noinline)) static int32_t weighted_mean(const fray_world *w, const int32_t *v, uint32_t first,
                                                       uint32_t end) {
  int64_t sum = 0;
  int64_t mass = 0;
  for (uint32_t p = first; p < end; ++p) {
    const int32_t half_masses = particle_is_half(w, p) ? 1 : 2;
    sum += (int64_t)v[p] * half_masses;
    mass += half_masses;
  }
  return mass > 0 ? (int32_t)(sum / mass) : 0;
}

/* v - mean in fewer bits: positions to Q13, velocities to Q16. */
__attribute__((noinline)) static int32_t relative(int32_t v, int32_t mean, unsigned down) {
  FRAY_ASSERT(down < 32);
  return (int32_t)fx_round64((int64_t)v - mean, down);
}

/* loop_rotation() with masses, for a cloth with split crossings. */
__attribute__((noinline)) static void weighted_rotation(const fray_world *w, rigid_fit *m, uint32_t first,
                                                        uint32_t end) {
  const vec3 x_cm = vec_make(weighted_mean(w, w->p.x, first, end), weighted_mean(w, w->p.y, first, end),
                             weighted_mean(w, w->p.z, first, end));
  const vec3 v_cm = vec_make(weighted_mean(w, w->p.vx, first, end), weighted_mean(w, w->p.vy, first, end),
                             weighted_mean(w, w->p.vz, first, end));
  bytes_zero(m, sizeof *m);
  m->centre = x_cm;
  m->velocity = v_cm;
  for (uint32_t p = first; p < end; ++p) {
    const int32_t x[3] = {relative(w->p.x[p], x_cm.x, 11), relative(w->p.y[p], x_cm.y, 11),
                          relative(w->p.z[p], x_cm.z, 11)};
    const int32_t v[3] = {relative(w->p.vx[p], v_cm.x, 12), relative(w->p.vy[p], v_cm.y, 12),
                          relative(w->p.vz[p], v_cm.z, 12)};
    const int32_t half_masses = particle_is_half(w, p) ? 1 : 2;
    for (uint32_t n = 0; n < 3; ++n) {
      const uint32_t k = (n + 1u) % 3u;
      const uint32_t l = (n + 2u) % 3u;
      m->inertia[n] += (fx_mul_wide(x[k], x[k]) + fx_mul_wide(x[l], x[l])) * half_masses;
      m->inertia[5u - n] -= fx_mul_wide(x[k], x[l]) * half_masses; /* 3 xy, 4 xz, 5 yz */
      m->momentum[n] += (fx_mul_wide(x[k], v[l]) - fx_mul_wide(x[l], v[k])) * half_masses;
    }
  }
}

__attribute__((noinline)) static void damp_relative(fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first < end && end <= w->capacity[POOL_PARTICLES]);
  rigid_fit m;
  if (end == (uint32_t)w->params->particles)
    simd_rotation(w->kernel, &m, w->p.x, w->p.y, w->p.z, w->p.vx, w->p.vy, w->p.vz, first, end);
  else
    weighted_rotation(w, &m, first, end);
  angular_velocity(m.inertia, m.momentum, m.turn);
  simd_follow(w->kernel, &m, w->params->relative_damping, w->p.x, w->p.y, w->p.z, w->p.vx, w->p.vy, w->p.vz,
              first, end);
}

void damp_begin(fray_world *w) {
  FRAY_ASSERT(!world_has_membrane(w));
  FRAY_ASSERT(particles_attached(w) <= w->p.count && w->p.count <= w->capacity[POOL_PARTICLES]);
  const uint32_t first = particles_attached(w);
  const uint32_t end = w->p.count;
  if (first != end && w->params->relative_damping != 0) damp_relative(w, first, end);
}

void damp_range(fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first >= particles_attached(w) && end <= w->p.count);
  const int32_t drag = w->params->drag;
  if (drag == 0) return;
  simd_drag(w->kernel, w->p.vx, first, end, drag);
  simd_drag(w->kernel, w->p.vy, first, end, drag);
  simd_drag(w->kernel, w->p.vz, first, end, drag);
}

void damp_apply(fray_world *w) {
  FRAY_ASSERT(!world_has_membrane(w));
  damp_begin(w);
  energy_stage(w, FRAY_ENERGY_DAMPING);
  damp_range(w, particles_attached(w), w->p.count);
}
