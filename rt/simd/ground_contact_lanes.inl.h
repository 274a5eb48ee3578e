/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: rt/contact/contact_primitives.c. Contacts with a plane that faces up,
 * GROUND_CONTACT_LANES_MOST at a time, in plain loops that compilers vectorise. Magnitudes and signs are
 * kept apart, so that all shifts are unsigned. */
#ifndef FRAY_SIMD_GROUND_CONTACT_LANES_INL_H
#define FRAY_SIMD_GROUND_CONTACT_LANES_INL_H

#include "rt/simd/ground_contact_view.h"
#include "rt/state/crossing.h"

enum { GROUND_CONTACT_LANES_MOST = 32, GROUND_CONTACT_LANES_ROUND = 16 };

/* Particles that touch the plane, padded to a multiple of GROUND_CONTACT_LANES_ROUND with copies of mass 0.
 */
typedef struct {
  uint32_t particle[GROUND_CONTACT_LANES_MOST];
  int32_t half_masses[GROUND_CONTACT_LANES_MOST]; /* mass in half crossings */
  int32_t at[3][GROUND_CONTACT_LANES_MOST], slip[3][GROUND_CONTACT_LANES_MOST],
      out[3][GROUND_CONTACT_LANES_MOST];
  uint32_t inverse[GROUND_CONTACT_LANES_MOST], limit[GROUND_CONTACT_LANES_MOST],
      sticks[GROUND_CONTACT_LANES_MOST];
  uint64_t h[GROUND_CONTACT_LANES_MOST];
} ground_contact_lanes;

/* n 2^bits, or n if it has fewer than `bits` leading zeros. */
static inline uint64_t ground_contact_lanes_normalise(uint64_t n, unsigned bits) {
  return n >> (64u - bits) == 0 ? n << bits : n;
}
static inline uint32_t ground_contact_lanes_shift(uint64_t n, unsigned bits) {
  return n >> (64u - bits) == 0 ? bits / 2u : 0;
}

FX_WRAPS static inline uint32_t ground_contact_lanes_newton(uint32_t m, uint32_t y) {
  const uint32_t squared = (uint32_t)((uint64_t)y * y >> 31);
  const uint32_t unity = (uint32_t)((uint64_t)m * squared >> 30);
  const int32_t short_of = (int32_t)(0x80000000u - unity);
  return y + (uint32_t)((uint64_t)((int64_t)(int32_t)y * short_of) >> 32);
}

/* fx_rsqrt(n, FX_ROOT_FINE): inverse and h; undefined where n is 0. */
FX_WRAPS static inline void ground_contact_lanes_rsqrt(ground_contact_lanes *s, uint32_t count) {
  for (uint32_t k = 0; k < count; ++k) {
    uint64_t n = fx_square(s->slip[0][k]) + fx_square(s->slip[1][k]) + fx_square(s->slip[2][k]);
    s->sticks[k] = n <= (uint64_t)s->limit[k] * s->limit[k];
    uint32_t up = ground_contact_lanes_shift(n, 32);
    n = ground_contact_lanes_normalise(n, 32);
    up += ground_contact_lanes_shift(n, 16);
    n = ground_contact_lanes_normalise(n, 16);
    up += ground_contact_lanes_shift(n, 8);
    n = ground_contact_lanes_normalise(n, 8);
    up += ground_contact_lanes_shift(n, 4);
    n = ground_contact_lanes_normalise(n, 4);
    up += ground_contact_lanes_shift(n, 2);
    n = ground_contact_lanes_normalise(n, 2);
    const uint32_t m = (uint32_t)(n >> 32);
    const uint32_t low = 2716337504u - (uint32_t)((uint64_t)m * 616403730u >> 30);
    const uint32_t high = 1922456487u - (uint32_t)((uint64_t)m * 217931629u >> 30);
    const uint32_t y = ground_contact_lanes_newton(
        m, ground_contact_lanes_newton(m, ground_contact_lanes_newton(m, m < 0x80000000u ? low : high)));
    s->inverse[k] = y > 0x80000000u ? 0x80000000u : y;
    s->h[k] = 31u - up;
  }
}

/* The part of the slip along an axis that friction removes: all of it, or its component of `limit`. */
FX_WRAPS static inline void ground_contact_lanes_friction(const ground_contact_lanes *s, int32_t *slip,
                                                          uint32_t count) {
  for (uint32_t k = 0; k < count; ++k) {
    const int32_t all = slip[k];
    const uint64_t product = (uint64_t)fx_magnitude(all) * s->inverse[k];
    const uint64_t unit = ((product >> s->h[k]) + 1u) >> 1;
    const uint32_t most = 1u << 30;
    const uint32_t share = unit > most ? most : (uint32_t)unit;
    const uint32_t part = (uint32_t)(((uint64_t)share * s->limit[k] + (1u << 29)) >> 30);
    const int32_t some = all < 0 ? -(int32_t)part : (int32_t)part;
    slip[k] = s->sticks[k] != 0 ? all : some;
  }
}

/* Moves by `out` - `back` within the world; `back` becomes the distance moved. */
FX_WRAPS static inline uint32_t ground_contact_lanes_move(int32_t *restrict at, const int32_t *restrict out,
                                                          int32_t *restrict back, uint32_t count) {
  uint32_t held_back = 0;
  for (uint32_t k = 0; k < count; ++k) {
    const int32_t before = at[k];
    const int32_t wanted = fx_add_saturated(before, fx_wrap_sub(out[k], back[k]));
    const int32_t place = fx_clamp(wanted, fx_min(before, -FX_WORLD_MAX), fx_max(before, FX_WORLD_MAX));
    held_back |= (uint32_t)(place ^ wanted);
    at[k] = place;
    back[k] = fx_wrap_sub(place, before);
  }
  return held_back;
}

FX_WRAPS static inline void ground_contact_lanes_load(const ground_contact_view *v, ground_contact_lanes *s,
                                                      uint32_t count, uint32_t whole) {
  for (uint32_t k = count; k < whole; ++k) {
    s->particle[k] = s->particle[0];
    s->half_masses[k] = 0;
  }
  const int32_t body_moved[3] = {v->body_moved.x, v->body_moved.y, v->body_moved.z};
  for (int a = 0; a < 3; ++a) {
    int32_t speed[GROUND_CONTACT_LANES_MOST];
    int32_t since[GROUND_CONTACT_LANES_MOST];
    for (uint32_t k = 0; k < whole; ++k) {
      const uint32_t p = s->particle[k];
      s->at[a][k] = v->at[a][p];
      speed[k] = v->speed[a][p];
      since[k] = fx_wrap_sub(v->at[a][p], v->predicted[a][p]);
    }
    for (uint32_t k = 0; k < whole; ++k)
      s->slip[a][k] = fx_wrap_sub(fx_wrap_add(fx_round(speed[k], FX_SUB_BITS), since[k]), body_moved[a]);
  }
  for (uint32_t k = 0; k < whole; ++k) {
    const uint32_t deep = (uint32_t)v->skin - (uint32_t)fx_wrap_sub(s->at[1][k], v->height);
    const uint32_t most =
        contact_depth_made(s->slip[0][k], s->slip[1][k], s->slip[2][k]) + (uint32_t)v->rise;
    const uint32_t depth = k >= count ? 0 : deep > most ? most : deep;
    const int32_t moved = fx_wrap_add(s->slip[1][k], (int32_t)depth);
    const uint64_t limit = (uint64_t)depth * (uint32_t)v->friction >> 16;
    s->out[0][k] = s->out[2][k] = 0;
    s->out[1][k] = (int32_t)depth;
    s->slip[1][k] = fx_wrap_sub(moved, fx_max(moved, -INT32_MAX));
    s->limit[k] = limit > INT32_MAX ? INT32_MAX : (uint32_t)limit;
  }
}

static inline void ground_contact_lanes_solve(ground_contact_view *v, ground_contact_lanes *s,
                                              uint32_t count) {
  FRAY_ASSERT(count > 0 && count <= GROUND_CONTACT_LANES_MOST);
  const uint32_t whole =
      (count + GROUND_CONTACT_LANES_ROUND - 1u) / GROUND_CONTACT_LANES_ROUND * GROUND_CONTACT_LANES_ROUND;
  ground_contact_lanes_load(v, s, count, whole);
  ground_contact_lanes_rsqrt(s, whole);
  for (int a = 0; a < 3; ++a) {
    ground_contact_lanes_friction(s, s->slip[a], whole);
    v->held_back |= ground_contact_lanes_move(s->at[a], s->out[a], s->slip[a], whole);
    int64_t sum = 0;
    for (uint32_t k = 0; k < whole; ++k) sum += (int64_t)s->slip[a][k] * s->half_masses[k];
    v->pushed[a] += sum;
    for (uint32_t k = 0; k < count; ++k) v->at[a][s->particle[k]] = s->at[a][k];
  }
}

static inline int32_t ground_contact_lanes_half_masses(const ground_contact_view *v, uint32_t p) {
  return v->crossing_state == NULL || (v->crossing_state[v->crossing_of[p]] & CROSSING_STATE) == FRAY_WHOLE
             ? 2
             : 1;
}

static inline uint32_t ground_contact_lanes_run(ground_contact_view *v, uint32_t first, uint32_t end) {
  FRAY_ASSERT(first <= end && v->friction >= 0);
  ground_contact_lanes s;
  uint32_t count = 0;
  for (uint32_t n = first; n < end; ++n) {
    contact *c = &v->contacts[n];
    const uint32_t p = c->particle;
    const int touches = fx_wrap_sub(v->at[1][p], v->height) < v->skin;
    c->touching = touches ? CONTACT_GROUND : CONTACT_APART;
    s.particle[count] = p;
    s.half_masses[count] = ground_contact_lanes_half_masses(v, p);
    count += touches ? 1u : 0u;
    if (count == GROUND_CONTACT_LANES_MOST) {
      ground_contact_lanes_solve(v, &s, count);
      count = 0;
    }
  }
  if (count != 0) ground_contact_lanes_solve(v, &s, count);
  return end - first;
}

#endif
