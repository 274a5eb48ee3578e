/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns of a loose couple slide over each other (Metaaphanon 2009, section 3.3, equation 1): of the
 * springs at its warp and weft particle the closest pair is kept the cloth's thickness T apart. With
 * gap d, unit normal n from weft to warp and barycentric weights b of the closest points, the ends of
 * the warp's spring move by
 *
 *   w_i b_i (T - d) / sum(w_k b_k^2) n
 *
 * and those of the weft's spring by the opposite, where w is 2 for a light end, 1 for a whole crossing
 * and 0 for a held one. As printed the equation lacks the sum, and overshoots: at an end of both
 * springs a gap of 2 T becomes 0.
 *
 * The gap's sign comes from the weave. A yarn that was pushed through its partner is put back, by
 * moving the predicted positions too, so that this gives nobody a velocity. No couple is moved by more
 * than a quarter of T in a substep: what is farther off was torn away or thrown together, and would be
 * shot back. Friction takes back of the slip in this substep, at the closest points, what Coulomb's law
 * allows: slip_friction of the correction that presses, and slip_grip besides, which stands for yarns
 * that press each other at rest. */
#include "rt/stage/slip.h"

#include "rt/model/couples.h"
#include "rt/stage/stage.h"

enum { COARSE_BITS = 8, COARSE_MAX = 16383 };
#define NOBODY UINT32_MAX

/* num / den in Q15, at most 1, both above 0: of the denominator 16 bits, behind the lowest 15. */
static int32_t share_of(int64_t num, int64_t den) {
  const int64_t whole = fx_asr64(num, 15);
  const int64_t d = fx_asr64(den, 15);
  if (whole >= d) return SLIP_ONE;
  const unsigned bits = 64u - fx_leading_zeros64((uint64_t)d);
  const unsigned down = bits > 16u ? bits - 16u : 0u;
  const uint32_t n = (uint32_t)(down >= 15u ? whole >> (down - 15u) : whole << (15u - down));
  return fx_min((int32_t)(n / (uint32_t)(d >> down)), SLIP_ONE);
}

/* The length of a spring, squared, as a divisor: in 16 bits. */
typedef struct {
  int32_t whole;
  uint32_t part;
  unsigned down; /* by which it is shifted, 14 at most */
} slip_divisor;

static slip_divisor divisor_of(int32_t squared) {
  const unsigned bits = 32u - (unsigned)__builtin_clz((uint32_t)squared | 1u);
  const unsigned down = bits > 16u ? bits - 16u : 0u;
  const slip_divisor d = {squared, (uint32_t)squared >> down, down};
  return d;
}

/* (whole + low / 2^15) / d in Q15, 0 to 1. */
static int32_t share_on(int32_t whole, uint32_t low, const slip_divisor *d) {
  if (whole < 0 || d->whole == 0) return 0;
  if (whole >= d->whole) return SLIP_ONE;
  const uint32_t n = (uint32_t)whole << (15u - d->down) | low >> d->down;
  return fx_min((int32_t)(n / d->part), SLIP_ONE);
}

static int32_t bounded(int32_t v) { return fx_clamp(v, -COARSE_MAX, COARSE_MAX); }
static int32_t coarse(int32_t d) { return bounded(fx_round(d, COARSE_BITS)); }

static vec3 coarse_way(vec3 from, vec3 to) {
  return vec_make(coarse(fx_sub(to.x, from.x)), coarse(fx_sub(to.y, from.y)),
                  coarse(fx_sub(to.z, from.z)));
}

static int32_t dot(vec3 a, vec3 b) { return fx_mul(a.x, b.x) + fx_mul(a.y, b.y) + fx_mul(a.z, b.z); }

/* The springs of a couple that are whole: the particle at their far end, by way, or NOBODY; and the
 * way there. */
typedef struct {
  uint32_t warp, weft; /* particles */
  uint32_t far[4];
  vec3 way[4]; /* coarse */
  slip_divisor squared[4]; /* of way */
  int32_t towards[4];      /* its product with apart */
  vec3 apart;  /* from weft to warp, coarse */
} slip_star;

/* Closest points of two springs that begin r apart: how far along a and b, Q15; returns |gap|^2 in
 * coarse units. aa, ar, bb, br: their products with themselves and with r. */
__attribute__((noinline)) static int32_t closest(const slip_star *star, uint32_t warp,
                                                 uint32_t weft, int32_t *s, int32_t *t) {
  const vec3 r = star->apart;
  const vec3 a = star->way[warp];
  const vec3 b = star->way[weft];
  const slip_divisor *aa = &star->squared[warp];
  const slip_divisor *bb = &star->squared[weft];
  const int32_t ab = dot(a, b);
  const int32_t ar = star->towards[warp];
  const int32_t br = star->towards[weft];
  const int64_t den = fx_mul_wide(aa->whole, bb->whole) - fx_mul_wide(ab, ab);
  *s = 0;
  if (den > 1 << 16) {
    const int64_t num = fx_mul_wide(ab, br) - fx_mul_wide(ar, bb->whole);
    *s = num <= 0 ? 0 : share_of(num, den);
  }
  const int64_t along = fx_mul_wide(ab, *s) + (int64_t)br * SLIP_ONE;
  *t = share_on((int32_t)fx_asr64(along, 15), (uint32_t)along & (SLIP_ONE - 1u), bb);
  if (*t == 0 || *t == SLIP_ONE) *s = share_on((*t == 0 ? 0 : ab) - ar, 0, aa);
  const vec3 gap = vec_make(bounded(r.x + fx_asr(a.x * *s - b.x * *t, 15)),
                            bounded(r.y + fx_asr(a.y * *s - b.y * *t, 15)),
                            bounded(r.z + fx_asr(a.z * *s - b.z * *t, 15)));
  return dot(gap, gap);
}

__attribute__((noinline)) static vec3 point_of(const fray_world *w, const slip_pair *pair,
                                               uint32_t first) {
  const vec3 near = world_position(w, pair->p[first]);
  const vec3 way = vec_sub(world_position(w, pair->p[first + 1u]), near);
  const int32_t b = pair->b[first + 1u];
  return vec_add(near, vec_make((int32_t)fx_round64(fx_mul_wide(way.x, b), 15),
                                (int32_t)fx_round64(fx_mul_wide(way.y, b), 15),
                                (int32_t)fx_round64(fx_mul_wide(way.z, b), 15)));
}

vec3 slip_gap(const fray_world *w, const slip_pair *pair) {
  return vec_sub(point_of(w, pair, 0), point_of(w, pair, 2));
}

/* Twice the inverse mass, in whole crossings: 2 light, 1 whole, 0 held. */
static int32_t ease_of(const fray_world *w, uint32_t p) {
  if (p < (uint32_t)w->params->held) return 0;
  return world_has_yarns(w) && couple_is_light(w, p) ? 2 : 1; /* none without: self-collision */
}

typedef struct {
  int32_t ease[4];
  int32_t share[4]; /* of the way apart that an end takes, Q15; of a held one, as if it were light */
  int32_t sum;      /* of ease b^2, Q15 */
  uint32_t last;    /* the end that makes up for what rounding left */
} slip_weights;

/* Returns 0 iff nothing is free to move. */
__attribute__((noinline)) static int weigh(const fray_world *w, const slip_pair *pair,
                                           slip_weights *k) {
  k->sum = 0;
  k->last = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    k->ease[n] = ease_of(w, pair->p[n]);
    k->sum += k->ease[n] * fx_asr(pair->b[n] * (pair->b[n] / 2), 14);
    if (k->ease[n] * pair->b[n] > k->ease[k->last] * pair->b[k->last]) k->last = n;
  }
  if (k->sum < SLIP_ONE / 8) return 0;
  for (uint32_t n = 0; n < 4; ++n) {
    const int32_t ease = k->ease[n] != 0 ? k->ease[n] : 2;
    k->share[n] = (int32_t)(((uint32_t)(pair->b[n] * ease) << 15) / (uint32_t)k->sum);
  }
  return 1;
}

/* num / den rounded, den > 0. */
static int32_t quotient(int32_t num, int32_t den) {
  const int32_t n = fx_clamp(num, -(1 << 30), 1 << 30);
  return n < 0 ? -((-n + den / 2) / den) : (n + den / 2) / den;
}

/* One axis. Each end moves outwards; `moved` gets how far. Returns what the momenta, in half crossings
 * times steps, of the warp's and the weft's side are apart. */
static int32_t part(const slip_pair *pair, const slip_weights *k, int32_t by, int32_t moved[4],
                    int32_t held[4]) {
  int32_t missing = fx_wrap_shift(by, 15); /* small at the end */
  int32_t apart = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    const int32_t step = (int32_t)fx_round64(fx_mul_wide(by, k->share[n]), 15);
    moved[n] = k->ease[n] != 0 ? step : 0;
    held[n] = k->ease[n] != 0 ? 0 : step;
    missing = fx_wrap_sub(missing, fx_wrap_mul(moved[n], pair->b[n]));
  }
  moved[k->last] += quotient(missing, pair->b[k->last]);
  for (uint32_t n = 0; n < 4; ++n) {
    const int32_t momentum = moved[n] * (k->ease[n] == 1 ? 2 : 1) + held[n];
    apart += n < 2 ? momentum : -momentum;
  }
  return apart;
}

__attribute__((noinline)) static void move_axis(fray_world *w, const slip_pair *pair,
                                                const slip_weights *k, int32_t *const at[3],
                                                int32_t by, uint32_t axis, int quiet) {
  int32_t moved[4];
  int32_t held[4];
  const int32_t apart = part(pair, k, by, moved, held);
  for (uint32_t n = 0; n < 4; ++n) {
    const uint32_t p = pair->p[n];
    const int32_t way = n < 2 ? moved[n] : -moved[n];
    if (k->ease[n] != 0) at[0][p] = fx_add(at[0][p], way);
    if (k->ease[n] != 0 && quiet) at[1][p] = fx_add(at[1][p], way);
    if (k->ease[n] == 0 && !quiet) {
      int64_t gave[3] = {0, 0, 0};
      gave[axis] = (int64_t)(n < 2 ? -held[n] : held[n]) * (1 << (FX_SUB_BITS - 1));
      body_gave(&w->motion[w->grip_body[p]], gave[0], gave[1], gave[2]);
    }
  }
  if (quiet) return;
  const uint32_t last = k->last;
  const int32_t unit = k->ease[last] == 2 ? 1 << FX_SUB_BITS : 1 << (FX_SUB_BITS - 1);
  at[2][pair->p[last]] = fx_add_saturated(at[2][pair->p[last]], -apart * unit);
}

int slip_move(fray_world *w, const slip_pair *pair, vec3 by, int quiet) {
  slip_weights k;
  if (!weigh(w, pair, &k)) return 0;
  int32_t *const x[3] = {w->x, w->qx, w->vx};
  int32_t *const y[3] = {w->y, w->qy, w->vy};
  int32_t *const z[3] = {w->z, w->qz, w->vz};
  move_axis(w, pair, &k, x, by.x, 0, quiet);
  move_axis(w, pair, &k, y, by.y, 1, quiet);
  move_axis(w, pair, &k, z, by.z, 2, quiet);
  return 1;
}

__attribute__((noinline)) static void look_around(const fray_world *w, uint32_t c, slip_star *s) {
  s->warp = w->warp_at[c];
  s->weft = w->crossing[c];
  const vec3 at[2] = {world_position(w, s->weft), world_position(w, s->warp)};
  s->apart = coarse_way(at[0], at[1]);
  const weave_cross cross = weave_cross_at(world_weave(w), c);
  for (uint32_t way = 0; way < 4; ++way) {
    const uint32_t next = cross.next[way];
    s->far[way] = NOBODY;
    s->way[way] = vec_make(0, 0, 0);
    if (next == c || w->row_class[w->row_of[cross.link[way]]] == ROW_DEAD) continue;
    s->far[way] = way < 2 ? w->crossing[next] : w->warp_at[next];
    s->way[way] = coarse_way(at[way / 2u], world_position(w, s->far[way]));
    s->squared[way] = divisor_of(dot(s->way[way], s->way[way]));
    s->towards[way] = dot(s->way[way], s->apart);
  }
}

/* The closest of up to four pairs; 0 where one yarn has no spring left here. */
static int find_pair(const slip_star *s, slip_pair *pair) {
  int32_t least = INT32_MAX;
  for (uint32_t warp = 2; warp < 4; ++warp)
    for (uint32_t weft = 0; weft < 2; ++weft) {
      int32_t on_warp;
      int32_t on_weft;
      if (s->far[warp] == NOBODY || s->far[weft] == NOBODY) continue;
      const int32_t n = closest(s, warp, weft, &on_warp, &on_weft);
      if (n >= least) continue;
      least = n;
      pair->p[0] = s->warp;
      pair->p[1] = s->far[warp];
      pair->p[2] = s->weft;
      pair->p[3] = s->far[weft];
      pair->b[0] = SLIP_ONE - on_warp;
      pair->b[1] = on_warp;
      pair->b[2] = SLIP_ONE - on_weft;
      pair->b[3] = on_weft;
    }
  return least != INT32_MAX;
}

int slip_closest(const fray_world *w, uint32_t c, slip_pair *pair) {
  slip_star star;
  look_around(w, c, &star);
  return find_pair(&star, pair);
}

static vec3 half_way(vec3 back, vec3 on) {
  return vec_make(fx_asr(on.x - back.x, 1), fx_asr(on.y - back.y, 1), fx_asr(on.z - back.z, 1));
}

/* Towards the side on which the warp is, along warp x weft or against it. */
static vec3 side_of_warp(const fray_world *w, const slip_star *s, uint32_t c) {
  const vec3 a = half_way(s->way[2], s->way[3]);
  const vec3 b = half_way(s->way[0], s->way[1]);
  const int32_t sign = couple_warp_over(w, c) ? 1 : -1;
  return vec_make(sign * (fx_mul(a.y, b.z) - fx_mul(a.z, b.y)), sign * (fx_mul(a.z, b.x) - fx_mul(a.x, b.z)),
                  sign * (fx_mul(a.x, b.y) - fx_mul(a.y, b.x)));
}

/* Out of line, as others here: small targets have no room for a copy wherever one is used. */
__attribute__((noinline)) static vec3 unit_of(vec3 v, uint64_t squared, int32_t *length) {
  const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
  *length = (int32_t)fx_root_length(root);
  return vec_make(fx_root_unit(root, v.x), fx_root_unit(root, v.y), fx_root_unit(root, v.z));
}

__attribute__((noinline)) static vec3 scaled(vec3 unit, int32_t length) {
  return vec_scale_unit(unit, length);
}

/* v, made shorter iff it is longer than `limit`. */
static vec3 limited(vec3 v, int32_t limit) {
  const uint64_t squared = vec_squared(v);
  int32_t length;
  if (squared <= fx_square(limit)) return v;
  return scaled(unit_of(v, squared, &length), limit);
}

/* What a particle has moved in this substep: its step, and what projections have added. */
__attribute__((noinline)) static vec3 moved_of(const fray_world *w, uint32_t p) {
  return vec_make(fx_round(w->vx[p], FX_SUB_BITS) + fx_sub(w->x[p], w->qx[p]),
                  fx_round(w->vy[p], FX_SUB_BITS) + fx_sub(w->y[p], w->qy[p]),
                  fx_round(w->vz[p], FX_SUB_BITS) + fx_sub(w->z[p], w->qz[p]));
}

static vec3 friction(const fray_world *w, const slip_pair *pair, vec3 normal, int32_t pressed) {
  int64_t sum[3] = {0, 0, 0};
  for (uint32_t n = 0; n < 4; ++n) {
    const vec3 m = moved_of(w, pair->p[n]);
    const int32_t b = n < 2 ? pair->b[n] : -pair->b[n];
    sum[0] += fx_mul_wide(m.x, b);
    sum[1] += fx_mul_wide(m.y, b);
    sum[2] += fx_mul_wide(m.z, b);
  }
  const vec3 moved = vec_make(fx_saturate(fx_round64(sum[0], 15)), fx_saturate(fx_round64(sum[1], 15)),
                              fx_saturate(fx_round64(sum[2], 15)));
  const vec3 slip = vec_sub(moved, scaled(normal, vec_dot_unit(moved, normal)));
  return limited(slip, fx_saturate(w->yarns->slip_grip +
                                       (fx_mul_wide(pressed, w->yarns->slip_friction) >> 16)));
}

/* Whether the warp is on the wrong side. Yarns that cross aslant, and ends of yarns, which may lie beside
 * the other yarn on either side, say nothing about it. */
static int is_through(const slip_star *s, vec3 gap, vec3 side) {
  const int64_t along = fx_add64(fx_add64(fx_mul_wide(gap.x, side.x), fx_mul_wide(gap.y, side.y)),
                                 fx_mul_wide(gap.z, side.z));
  if (along >= 0) return 0;
  for (uint32_t way = 0; way < 4; ++way)
    if (s->far[way] == NOBODY) return 0;
  const vec3 a = half_way(s->way[2], s->way[3]);
  const vec3 b = half_way(s->way[0], s->way[1]);
  return vec_squared(side) / 4u > (uint64_t)fx_mul_wide(dot(a, a) / 4, dot(b, b) / 4); /* sine 1/2 */
}

void slip_couple(fray_world *w, uint32_t c) {
  slip_pair pair;
  slip_star star;
  look_around(w, c, &star);
  if (!find_pair(&star, &pair)) return;
  const int32_t thickness = w->params->thickness;
  const vec3 gap = slip_gap(w, &pair);
  const uint64_t squared = vec_squared(gap);
  const vec3 side = side_of_warp(w, &star, c);
  const int32_t most = thickness / 4;
  const int together = squared < fx_square(thickness / 16 + 1);
  const vec3 from = vec_make(together ? side.x : gap.x, together ? side.y : gap.y,
                             together ? side.z : gap.z);
  const uint64_t area = together ? vec_squared(side) : squared;
  if (area == 0) return;
  int32_t length;
  const vec3 normal = unit_of(from, area, &length);
  const int through = !together && is_through(&star, gap, side);
  const int quiet = together || through;
  const int32_t by = together ? most : through ? -most : fx_clamp(thickness - length, -most, most);
  vec3 way = scaled(normal, by);
  if (!quiet && (w->yarns->slip_friction | w->yarns->slip_grip) != 0)
    way = vec_sub(way, friction(w, &pair, normal, (int32_t)fx_magnitude(by)));
  slip_move(w, &pair, way, quiet);
}

/* All-yarn sheets (section 6): the particles of a couple are bound to each other, a thickness apart. */
__attribute__((noinline)) static void bind(fray_world *w, uint32_t c) {
  slip_star star;
  look_around(w, c, &star);
  const slip_pair pair = {{star.warp, star.warp, star.weft, star.weft}, {SLIP_ONE, 0, SLIP_ONE, 0}};
  const vec3 side = side_of_warp(w, &star, c);
  const uint64_t area = vec_squared(side);
  if (area == 0) return;
  int32_t length;
  const vec3 wanted = scaled(unit_of(side, area, &length), w->params->thickness);
  const vec3 by = vec_sub(wanted, slip_gap(w, &pair));
  slip_move(w, &pair, limited(by, w->params->thickness), 0);
}

/* Couples that slip in this tick, by colour. */
__attribute__((noinline)) static void find_couples(fray_world *w) {
  const uint32_t warps = (uint32_t)w->params->warps;
  for (uint32_t n = 0; n < SLIP_COLOURS; ++n) w->slip_head[n] = SLIP_NOBODY;
  for (uint32_t p = (uint32_t)w->params->particles; p < w->particles; ++p) {
    const uint32_t c = w->place[p];
    if (couple_at(w, c) == FRAY_DISCONNECTED) continue;
    uint32_t *head = &w->slip_head[(c - c / warps * (warps - 2u)) % SLIP_COLOURS];
    w->slip_next[c] = (row_id)*head;
    *head = c;
  }
}

void slip_run(fray_world *w, uint32_t substep) {
  if (!world_has_yarns(w)) return;
  if (substep == 0) {
    find_couples(w);
#if SLIP_PLANNED
    slip_plan(w);
#endif
  }
  for (uint32_t n = 0; n < SLIP_COLOURS; ++n) {
#if SLIP_PLANNED
    slip_run_planned(w, n);
#endif
    for (uint32_t c = w->slip_head[n]; c != SLIP_NOBODY; c = w->slip_next[c]) {
      if (couple_at(w, c) == FRAY_LOOSE)
        slip_couple(w, c);
      else
        bind(w, c);
      ++w->work.slips;
    }
  }
}
