/* SPDX-License-Identifier: Apache-2.0 */
/* Loops over particles that stand side by side in memory. Compilers make vectors of them, so the
 * wide ones are these very lines, compiled for other machines. Particles first..end-1. */
#ifndef FRAY_WIDE_SWEEPS_H
#define FRAY_WIDE_SWEEPS_H

#include "rt/base/vec.h"

enum {
  SWEEP_SPEED_MAX = INT32_MAX - (1 << 25),
  SWEEP_MOVED_MAX = 1 << 25 /* in a substep, by projections and collisions: 2 lu */
};

/* x: position, q: the predicted one, Q24 lu; v: Q28 lu per substep. The step in Q28 is rounded to
 * Q24 and what the rounding left over, r, joins the next step, so slow motion neither sticks nor
 * drifts. Returns 0 iff nothing was held back at the edge of the world. */
static inline uint32_t sweep_advance(int32_t *restrict x, int32_t *restrict q, int32_t *restrict v,
                                     int8_t *restrict r, uint32_t first, uint32_t end,
                                     int32_t gravity) {
  uint32_t at_edge = 0;
  for (uint32_t p = first; p < end; ++p) {
    const int32_t speed = fx_clamp_rare(v[p], -SWEEP_SPEED_MAX, SWEEP_SPEED_MAX) + gravity;
    const int32_t step = speed + r[p];
    const int32_t whole = fx_round(step, FX_SUB_BITS);
    const int32_t moved = fx_add(x[p], whole);
    const int32_t place = fx_clamp_rare(moved, -FX_WORLD_MAX, FX_WORLD_MAX);
    at_edge |= (uint32_t)(moved ^ place);
    v[p] = speed;
    r[p] = (int8_t)(step - whole * (1 << FX_SUB_BITS));
    x[p] = place;
    q[p] = place;
  }
  return at_edge;
}

static inline int32_t sweep_carried(int32_t centre, int32_t grip) {
  return fx_clamp(fx_add(centre, grip), -FX_WORLD_MAX, FX_WORLD_MAX);
}

/* Particles that a body holds go with it. */
static inline uint32_t sweep_carry(int32_t *restrict x, int32_t *restrict q, int32_t *restrict v,
                                   const int32_t *restrict grip, uint32_t first, uint32_t end,
                                   int32_t centre, int32_t velocity) {
  for (uint32_t p = first; p < end; ++p) {
    const int32_t place = sweep_carried(centre, grip[p]);
    x[p] = place;
    q[p] = place;
    v[p] = velocity;
  }
  return end - first;
}

/* v += (x - q) * 16, never re-derived from positions: what is below a position step is kept. */
static inline uint32_t sweep_take_over(const int32_t *restrict x, const int32_t *restrict q,
                                       int32_t *restrict v, uint32_t first, uint32_t end) {
  for (uint32_t p = first; p < end; ++p) {
    const int32_t moved = fx_clamp_rare(fx_sub(x[p], q[p]), -SWEEP_MOVED_MAX, SWEEP_MOVED_MAX);
    v[p] = fx_clamp_rare(fx_add(v[p], moved * (1 << FX_SUB_BITS)), -FX_SPEED_MAX, FX_SPEED_MAX);
  }
  return end - first;
}

/* v -= v * share, Q24. */
static inline uint32_t sweep_drag(int32_t *restrict v, uint32_t first, uint32_t end, int32_t share) {
  for (uint32_t p = first; p < end; ++p) v[p] -= (int32_t)fx_round64(fx_mul_wide(v[p], share), 24);
  return end - first;
}

/* Of a sheet about its centre. */
typedef struct {
  vec3 centre, velocity;
  int64_t inertia[6];  /* xx yy zz xy xz yz, Q26 */
  int64_t momentum[3]; /* Q29 */
  int64_t turn[3];     /* omega, Q28 radians per substep */
} sweep_motion;

static inline int32_t sweep_mean(const int32_t *restrict v, uint32_t first, uint32_t end) {
  int64_t sum = 0;
  for (uint32_t p = first; p < end; ++p) sum += v[p];
  return (int32_t)(sum / (int64_t)(end - first));
}

/* Fills in all but `turn`. */
static inline uint32_t sweep_turning(sweep_motion *m, const int32_t *restrict x,
                                const int32_t *restrict y, const int32_t *restrict z,
                                const int32_t *restrict vx, const int32_t *restrict vy,
                                const int32_t *restrict vz, uint32_t first, uint32_t end) {
  const vec3 c = vec_make(sweep_mean(x, first, end), sweep_mean(y, first, end),
                          sweep_mean(z, first, end));
  const vec3 g = vec_make(sweep_mean(vx, first, end), sweep_mean(vy, first, end),
                          sweep_mean(vz, first, end));
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

static inline int32_t sweep_approach(int32_t v, int64_t rigid, int32_t share) {
  const int32_t away = fx_saturate(rigid - v);
  return (int32_t)fx_clamp64(v + fx_round64(fx_mul_wide(away, share), 24), -FX_SPEED_MAX,
                             FX_SPEED_MAX);
}

/* Velocities approach the sheet's rigid motion by a share, Q24. */
static inline uint32_t sweep_follow(const sweep_motion *m, int32_t share, const int32_t *restrict x,
                               const int32_t *restrict y, const int32_t *restrict z,
                               int32_t *restrict vx, int32_t *restrict vy, int32_t *restrict vz,
                               uint32_t first, uint32_t end) {
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
    vx[p] = sweep_approach(vx[p], g.x + u, share);
    vy[p] = sweep_approach(vy[p], g.y + v, share);
    vz[p] = sweep_approach(vz[p], g.z + t, share);
  }
  return end - first;
}

#endif
