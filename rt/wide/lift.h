/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts with a plane that faces up, some at a time: plain loops, of which compilers make vectors.
 * Magnitudes apart from signs, so that shifts are those of naturals. */
#ifndef FRAY_WIDE_LIFT_H
#define FRAY_WIDE_LIFT_H

#include "rt/model/couples.h"
#include "rt/wide/level.h"

enum { LIFT_MOST = 32, LIFT_ROUND = 16 };

/* Particles that touch; behind the last one, up to a whole round, ones that are not pushed. */
typedef struct {
  uint32_t particle[LIFT_MOST];
  int32_t halves[LIFT_MOST]; /* of a crossing, that a particle weighs */
  int32_t at[3][LIFT_MOST], slip[3][LIFT_MOST], out[3][LIFT_MOST];
  uint32_t inverse[LIFT_MOST], limit[LIFT_MOST], sticks[LIFT_MOST];
  uint64_t h[LIFT_MOST];
} lift_some;

/* What has fewer than `bits` leading zeros stays. */
static inline uint64_t lift_raise(uint64_t n, unsigned bits) {
  return n >> (64u - bits) == 0 ? n << bits : n;
}
static inline uint32_t lift_raised(uint64_t n, unsigned bits) {
  return n >> (64u - bits) == 0 ? bits / 2u : 0;
}

FX_WRAPS static inline uint32_t lift_newton(uint32_t m, uint32_t y) {
  const uint32_t squared = (uint32_t)((uint64_t)y * y >> 31);
  const uint32_t unity = (uint32_t)((uint64_t)m * squared >> 30);
  const int32_t short_of = (int32_t)(0x80000000u - unity);
  return y + (uint32_t)((uint64_t)((int64_t)(int32_t)y * short_of) >> 32);
}

/* fx_rsqrt(n, FX_ROOT_FINE): inverse, and h; anything where n is 0. */
FX_WRAPS static inline void lift_rsqrt(lift_some *s, uint32_t count) {
  for (uint32_t k = 0; k < count; ++k) {
    uint64_t n = fx_square(s->slip[0][k]) + fx_square(s->slip[1][k]) + fx_square(s->slip[2][k]);
    s->sticks[k] = n <= (uint64_t)s->limit[k] * s->limit[k];
    uint32_t up = lift_raised(n, 32);
    n = lift_raise(n, 32);
    up += lift_raised(n, 16);
    n = lift_raise(n, 16);
    up += lift_raised(n, 8);
    n = lift_raise(n, 8);
    up += lift_raised(n, 4);
    n = lift_raise(n, 4);
    up += lift_raised(n, 2);
    n = lift_raise(n, 2);
    const uint32_t m = (uint32_t)(n >> 32);
    const uint32_t low = 2716337504u - (uint32_t)((uint64_t)m * 616403730u >> 30);
    const uint32_t high = 1922456487u - (uint32_t)((uint64_t)m * 217931629u >> 30);
    const uint32_t y = lift_newton(m, lift_newton(m, lift_newton(m, m < 0x80000000u ? low : high)));
    s->inverse[k] = y > 0x80000000u ? 0x80000000u : y;
    s->h[k] = 31u - up;
  }
}

/* What friction takes back along an axis: all of it, or its part of `limit`. */
FX_WRAPS static inline void lift_friction(const lift_some *s, int32_t *slip, uint32_t count) {
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

/* Moves by `out` - `back`, as far as the world goes; that comes to stand in `back`. */
FX_WRAPS static inline uint32_t lift_move(int32_t *restrict at, const int32_t *restrict out,
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

FX_WRAPS static inline void lift_fetch(const level_view *v, lift_some *s, uint32_t count, uint32_t whole) {
  for (uint32_t k = count; k < whole; ++k) {
    s->particle[k] = s->particle[0];
    s->halves[k] = 0;
  }
  const int32_t body_moved[3] = {v->body_moved.x, v->body_moved.y, v->body_moved.z};
  for (int a = 0; a < 3; ++a) {
    int32_t speed[LIFT_MOST];
    int32_t since[LIFT_MOST];
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
    const uint32_t depth = k >= count ? 0 : deep > INT32_MAX ? INT32_MAX : deep;
    const int32_t moved = fx_wrap_add(s->slip[1][k], (int32_t)depth);
    const uint64_t limit = (uint64_t)depth * (uint32_t)v->friction >> 16;
    s->out[0][k] = s->out[2][k] = 0;
    s->out[1][k] = (int32_t)depth;
    s->slip[1][k] = fx_wrap_sub(moved, fx_max(moved, -INT32_MAX));
    s->limit[k] = limit > INT32_MAX ? INT32_MAX : (uint32_t)limit;
  }
}

static inline void lift_take(level_view *v, lift_some *s, uint32_t count) {
  const uint32_t whole = (count + LIFT_ROUND - 1u) / LIFT_ROUND * LIFT_ROUND;
  lift_fetch(v, s, count, whole);
  lift_rsqrt(s, whole);
  for (int a = 0; a < 3; ++a) {
    lift_friction(s, s->slip[a], whole);
    v->held_back |= lift_move(s->at[a], s->out[a], s->slip[a], whole);
    int64_t sum = 0;
    for (uint32_t k = 0; k < whole; ++k) sum += (int64_t)s->slip[a][k] * s->halves[k];
    v->pushed[a] += sum;
    for (uint32_t k = 0; k < count; ++k) v->at[a][s->particle[k]] = s->at[a][k];
  }
}

static inline int32_t lift_halves(const level_view *v, uint32_t p) {
  return v->couple == NULL || (v->couple[v->place[p]] & COUPLE_STATE) == FRAY_WHOLE ? 2 : 1;
}

static inline uint32_t lift_contacts(level_view *v, uint32_t first, uint32_t end) {
  lift_some s;
  uint32_t count = 0;
  for (uint32_t n = first; n < end; ++n) {
    contact *c = &v->contacts[n];
    const uint32_t p = c->particle;
    const int touches = fx_wrap_sub(v->at[1][p], v->height) < v->skin;
    c->touching = touches ? CONTACT_LEVEL : CONTACT_APART;
    s.particle[count] = p;
    s.halves[count] = lift_halves(v, p);
    count += touches ? 1u : 0u;
    if (count == LIFT_MOST) {
      lift_take(v, &s, count);
      count = 0;
    }
  }
  if (count != 0) lift_take(v, &s, count);
  return end - first;
}

#endif
