/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/woven/yarn_pair.h"

#include "rt/state/crossing.h"

/* The point on the spring between ends `first` and first + 1: 0 of the warp, 2 of the weft. */
__attribute__((noinline)) static vec3 point_on_spring(const fray_world *w, const yarn_pair *pair,
                                                      uint32_t first) {
  return vec_lerp_q15(world_position(w, pair->particle[first]), world_position(w, pair->particle[first + 1u]),
                      pair->weight[first + 1u]);
}

vec3 yarn_pair_gap(const fray_world *w, const yarn_pair *pair) {
  FRAY_ASSERT(pair->weight[0] + pair->weight[1] == YARN_PAIR_ONE);
  FRAY_ASSERT(pair->weight[2] + pair->weight[3] == YARN_PAIR_ONE);
  return vec_sub(point_on_spring(w, pair, 0), point_on_spring(w, pair, 2));
}

typedef struct {
  int32_t inverse_mass[4];
  int32_t fraction[4]; /* of the displacement, Q15, by which an end moves; attached: as if of half a mass */
  int32_t sum;         /* of inverse_mass b^2, Q15 */
  uint32_t last;       /* the end that compensates rounding: the one that moves most */
} pair_weights;

/* Returns 0 iff no end is free to move. */
__attribute__((noinline)) static int find_weights(const fray_world *w, const yarn_pair *pair,
                                                  pair_weights *k) {
  k->sum = 0;
  k->last = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    k->inverse_mass[n] = particle_free_inverse_mass(w, pair->particle[n]);
    k->sum += k->inverse_mass[n] * fx_asr(pair->weight[n] * (pair->weight[n] / 2), 14);
    if (k->inverse_mass[n] * pair->weight[n] > k->inverse_mass[k->last] * pair->weight[k->last]) k->last = n;
  }
  if (k->sum < YARN_PAIR_ONE / 8) return 0;
  for (uint32_t n = 0; n < 4; ++n) {
    const int32_t inverse_mass = k->inverse_mass[n] != 0 ? k->inverse_mass[n] : 2;
    k->fraction[n] = (int32_t)(((uint32_t)(pair->weight[n] * inverse_mass) << 15) / (uint32_t)k->sum);
  }
  return 1;
}

/* num / den rounded, den > 0. */
static int32_t quotient(int32_t num, int32_t den) {
  const int32_t n = fx_clamp(num, -(1 << 30), 1 << 30);
  return n < 0 ? -((-n + den / 2) / den) : (n + den / 2) / den;
}

/* One axis: how far each end moves outwards, `moved` of free ends, `attached` of attached ones. Returns the
 * momentum of the warp's spring less that of the weft's, in half crossings times position steps. */
static int32_t find_moves(const yarn_pair *pair, const pair_weights *k, int32_t by, int32_t moved[4],
                          int32_t attached[4]) {
  int32_t missing = fx_wrap_shift(by, 15); /* the sum may wrap, what is left of it is small */
  int32_t surplus = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    const int32_t step = fx_mul_round(by, k->fraction[n], 15);
    moved[n] = k->inverse_mass[n] != 0 ? step : 0;
    attached[n] = k->inverse_mass[n] != 0 ? 0 : step;
    missing = fx_wrap_sub(missing, fx_wrap_mul(moved[n], pair->weight[n]));
  }
  moved[k->last] += quotient(missing, pair->weight[k->last]);
  for (uint32_t n = 0; n < 4; ++n) {
    const int32_t momentum = moved[n] * (k->inverse_mass[n] == 1 ? 2 : 1) + attached[n];
    surplus += n < 2 ? momentum : -momentum;
  }
  return surplus;
}

typedef struct {
  int32_t *x, *q, *v; /* position, predicted position, velocity of particles: one component */
} axis_view;

/* What rounding left of the momentum, body impulses included, goes to the velocity of the last end. */
__attribute__((noinline)) static void move_axis(fray_world *w, const yarn_pair *pair,
                                                const pair_weights *k, const axis_view *of, int32_t by,
                                                uint32_t axis, int keep_velocity) {
  int32_t moved[4];
  int32_t attached[4];
  const int32_t surplus = find_moves(pair, k, by, moved, attached);
  for (uint32_t n = 0; n < 4; ++n) {
    const uint32_t p = pair->particle[n];
    const int32_t step = n < 2 ? moved[n] : -moved[n];
    if (k->inverse_mass[n] != 0) of->x[p] = fx_add(of->x[p], step);
    if (k->inverse_mass[n] != 0 && keep_velocity)
      of->q[p] = fx_clamp(fx_add(of->q[p], step), -FX_WORLD_MAX, FX_WORLD_MAX);
    if (k->inverse_mass[n] == 0 && !keep_velocity) {
      int64_t *impulse = &w->rigid.motion[w->p.attach_body[p]].impulse[axis];
      *impulse = fx_add64(*impulse, (int64_t)(n < 2 ? -attached[n] : attached[n]) * (1 << (FX_SUB_BITS - 1)));
    }
  }
  if (keep_velocity) return;
  const uint32_t last = k->last;
  const int32_t unit = k->inverse_mass[last] == 2 ? 1 << FX_SUB_BITS : 1 << (FX_SUB_BITS - 1);
  of->v[pair->particle[last]] = fx_add_saturated(of->v[pair->particle[last]], -surplus * unit);
}

int yarn_pair_move(fray_world *w, const yarn_pair *pair, vec3 by, int keep_velocity) {
  FRAY_ASSERT(pair->weight[0] + pair->weight[1] == YARN_PAIR_ONE);
  FRAY_ASSERT(pair->weight[2] + pair->weight[3] == YARN_PAIR_ONE);
  pair_weights k;
  if (!find_weights(w, pair, &k)) return 0;
  const axis_view x = {w->p.x, w->p.qx, w->p.vx};
  const axis_view y = {w->p.y, w->p.qy, w->p.vy};
  const axis_view z = {w->p.z, w->p.qz, w->p.vz};
  move_axis(w, pair, &k, &x, by.x, 0, keep_velocity);
  move_axis(w, pair, &k, &y, by.y, 1, keep_velocity);
  move_axis(w, pair, &k, &z, by.z, 2, keep_velocity);
  return 1;
}
