/* SPDX-License-Identifier: Apache-2.0 */
/* Loops over particles first..end-1, consecutive in memory: plain C that compilers vectorise. The kernels
 * of SIMD_LOOPS are these loops, compiled for each instruction set. */
#ifndef FRAY_SIMD_PARTICLE_LOOPS_H
#define FRAY_SIMD_PARTICLE_LOOPS_H

#include "rt/base/vec.h"

enum {
  LOOP_SPEED_MAX = INT32_MAX - (1 << 25),
  LOOP_MOVED_MAX = 1 << 25 /* Q24: 2 lu in a substep, by strain limiting and collisions */
};

/* x: position, q: the predicted one, Q24 lu; v: Q28 lu per substep. The step in Q28 is rounded to
 * Q24 and the rounding remainder r is added to the next step, so slow motion neither sticks nor
 * drifts. The edge of the world stops what would leave it: a speed that went on growing there would be
 * energy from nothing. Returns 0 iff no particle was held back at the edge. */
static inline uint32_t loop_advance(int32_t *restrict x, int32_t *restrict q, int32_t *restrict v,
                                    int8_t *restrict r, uint32_t first, uint32_t end, int32_t gravity) {
  FRAY_ASSERT(first <= end);
  uint32_t at_edge = 0;
  for (uint32_t p = first; p < end; ++p) {
    const int32_t speed = fx_clamp_rare(v[p], -LOOP_SPEED_MAX, LOOP_SPEED_MAX) + gravity;
    const int32_t step = speed + r[p];
    const int32_t whole = fx_round(step, FX_SUB_BITS);
    const int32_t moved = fx_add(x[p], whole);
    const int is_inside = fx_magnitude(moved) <= (uint32_t)FX_WORLD_MAX;
    const int32_t place = is_inside ? moved : moved < 0 ? -FX_WORLD_MAX : FX_WORLD_MAX;
    at_edge |= (uint32_t)(moved ^ place);
    v[p] = is_inside ? speed : 0;
    r[p] = (int8_t)(step - whole * (1 << FX_SUB_BITS));
    x[p] = place;
    q[p] = place;
  }
  return at_edge;
}

static inline int32_t loop_carried(int32_t centre, int32_t offset) {
  return fx_clamp(fx_add(centre, offset), -FX_WORLD_MAX, FX_WORLD_MAX);
}

/* Attached particles move with their body: x = q = centre + offset, v = velocity. */
static inline uint32_t loop_carry(int32_t *restrict x, int32_t *restrict q, int32_t *restrict v,
                                  const int32_t *restrict offset, uint32_t first, uint32_t end,
                                  int32_t centre, int32_t velocity) {
  FRAY_ASSERT(first <= end);
  for (uint32_t p = first; p < end; ++p) {
    const int32_t place = loop_carried(centre, offset[p]);
    x[p] = place;
    q[p] = place;
    v[p] = velocity;
  }
  return end - first;
}

/* v += 16 (x - q): velocities are corrected, not re-derived, which keeps their bits below a position step.
 */
static inline uint32_t loop_velocity(const int32_t *restrict x, const int32_t *restrict q,
                                     int32_t *restrict v, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first <= end);
  for (uint32_t p = first; p < end; ++p) {
    const int32_t moved = fx_clamp_rare(fx_wrap_sub(x[p], q[p]), -LOOP_MOVED_MAX, LOOP_MOVED_MAX);
    v[p] = fx_clamp_rare(fx_add(v[p], moved * (1 << FX_SUB_BITS)), -FX_SPEED_MAX, FX_SPEED_MAX);
  }
  return end - first;
}

/* v -= v * share, share in Q24 of 0..1. */
static inline uint32_t loop_drag(int32_t *restrict v, uint32_t first, uint32_t end, int32_t share) {
  FRAY_ASSERT(share >= 0 && share <= 1 << 24);
  FRAY_ASSERT(first <= end);
  for (uint32_t p = first; p < end; ++p) v[p] -= fx_mul_round(v[p], share, 24);
  return end - first;
}

/* The rigid motion that fits a cloth, about its centre. */
typedef struct {
  vec3 centre, velocity;
  int64_t inertia[6];  /* xx yy zz xy xz yz, Q26 */
  int64_t momentum[3]; /* Q29 */
  int64_t turn[3];     /* omega, Q28 radians per substep */
} rigid_fit;

static inline int32_t loop_mean(const int32_t *restrict v, uint32_t first, uint32_t end) {
  int64_t sum = 0;
  for (uint32_t p = first; p < end; ++p) sum += v[p];
  return (int32_t)(sum / (int64_t)(end - first));
}

/* Sums the moments of the particles: all of *m but `turn`. */
static inline uint32_t loop_rotation(rigid_fit *m, const int32_t *restrict x, const int32_t *restrict y,
                                     const int32_t *restrict z, const int32_t *restrict vx,
                                     const int32_t *restrict vy, const int32_t *restrict vz, uint32_t first,
                                     uint32_t end) {
  FRAY_ASSERT(first < end);
  const vec3 c = vec_make(loop_mean(x, first, end), loop_mean(y, first, end), loop_mean(z, first, end));
  const vec3 g = vec_make(loop_mean(vx, first, end), loop_mean(vy, first, end), loop_mean(vz, first, end));
  int64_t xx = 0;
  int64_t yy = 0;
  int64_t zz = 0;
  int64_t xy = 0;
  int64_t xz = 0;
  int64_t yz = 0;
  int64_t turn_x = 0;
  int64_t turn_y = 0;
  int64_t turn_z = 0;
  for (uint32_t p = first; p < end; ++p) {
    const int32_t i = (int32_t)fx_round64((int64_t)x[p] - c.x, 11); /* Q13 */
    const int32_t j = (int32_t)fx_round64((int64_t)y[p] - c.y, 11);
    const int32_t k = (int32_t)fx_round64((int64_t)z[p] - c.z, 11);
    const int32_t u = (int32_t)fx_round64((int64_t)vx[p] - g.x, 12); /* Q16 */
    const int32_t v = (int32_t)fx_round64((int64_t)vy[p] - g.y, 12);
    const int32_t t = (int32_t)fx_round64((int64_t)vz[p] - g.z, 12);
    xx += fx_mul_wide(i, i);
    yy += fx_mul_wide(j, j);
    zz += fx_mul_wide(k, k);
    xy += fx_mul_wide(i, j);
    xz += fx_mul_wide(i, k);
    yz += fx_mul_wide(j, k);
    turn_x += fx_mul_wide(j, t) - fx_mul_wide(k, v);
    turn_y += fx_mul_wide(k, u) - fx_mul_wide(i, t);
    turn_z += fx_mul_wide(i, v) - fx_mul_wide(j, u);
  }
  const int64_t inertia[6] = {yy + zz, xx + zz, xx + yy, -xy, -xz, -yz};
  for (int n = 0; n < 6; ++n) m->inertia[n] = inertia[n];
  m->centre = c;
  m->velocity = g;
  m->momentum[0] = turn_x;
  m->momentum[1] = turn_y;
  m->momentum[2] = turn_z;
  return end - first;
}

static inline int32_t loop_approach(int32_t v, int64_t rigid, int32_t share) {
  const int32_t away = fx_saturate(rigid - v);
  return fx_clamp_wide(v + fx_round64(fx_mul_wide(away, share), 24), FX_SPEED_MAX);
}

/* Velocities approach the rigid motion by `share`, Q24 of 0..1. */
static inline uint32_t loop_follow(const rigid_fit *m, int32_t share, const int32_t *restrict x,
                                   const int32_t *restrict y, const int32_t *restrict z,
                                   int32_t *restrict vx, int32_t *restrict vy, int32_t *restrict vz,
                                   uint32_t first, uint32_t end) {
  FRAY_ASSERT(first <= end);
  const vec3 c = m->centre;
  const vec3 g = m->velocity;
  const int64_t turn[3] = {m->turn[0], m->turn[1], m->turn[2]};
  for (uint32_t p = first; p < end; ++p) {
    const int64_t i = (int64_t)x[p] - c.x;
    const int64_t j = (int64_t)y[p] - c.y;
    const int64_t k = (int64_t)z[p] - c.z;
    /* products below 2^31 * 2^31 each; Q52 to Q28 */
    const int64_t u = fx_round64(fx_mul64(turn[1], k) - fx_mul64(turn[2], j), 24);
    const int64_t v = fx_round64(fx_mul64(turn[2], i) - fx_mul64(turn[0], k), 24);
    const int64_t t = fx_round64(fx_mul64(turn[0], j) - fx_mul64(turn[1], i), 24);
    vx[p] = loop_approach(vx[p], g.x + u, share);
    vy[p] = loop_approach(vy[p], g.y + v, share);
    vz[p] = loop_approach(vz[p], g.z + t, share);
  }
  return end - first;
}

#endif
