/* SPDX-License-Identifier: Apache-2.0 */
/* SIMD twin: rt/simd/yarn_slip_lanes.inl.h, for the crossings that yarn_slip_list.c lists.
 *
 * The yarns of a loose crossing slide over each other (Metaaphanon 2009, section 3.3, equation 1): of the
 * springs at its warp and its weft particle the closest pair is kept the cloth's thickness T apart. With
 * gap d, unit normal n from weft to warp and barycentric weights b of the closest points, the ends of the
 * warp's spring move by
 *
 *   w_i b_i (T - d) / sum(w_k b_k^2) n
 *
 * and those of the weft's spring by the opposite, where the inverse mass w is 2 for an end of half the
 * mass, 1 for a whole crossing and 0 for an attached one. As printed the equation lacks the sum, and
 * overshoots: at an end of both springs a gap of 2 T becomes 0.
 *
 * The gap's sign comes from the weave. A yarn that was pushed through its partner is put back, and its
 * predicted position moves with it, so that no velocity results. No crossing is moved by more than a
 * quarter of T in a substep: yarns farther off were torn away or thrown together, and would be shot back.
 * Friction removes as much of the slip in this substep, at the closest points, as Coulomb's law allows:
 * slip_friction times the correction that presses the yarns apart, and in addition crossing_friction, for
 * yarns that press each other at rest.
 *
 * Closest points are found in coarse units of 2^COARSE_BITS position steps: components are below 2^14, so
 * products and their sums fit 32 bits. Functions are kept out of line because small targets have no room
 * for copies. */
#include "rt/woven/yarn_slip.h"

#include "rt/base/coulomb.h"
#include "rt/state/crossing.h"
#include "rt/woven/woven.h"

enum { COARSE_BITS = 8, COARSE_MAX = 16383 };
#define NO_PARTICLE UINT32_MAX

/* num / den in Q15, at most 1, both above 0: of the denominator the upper 16 bits, without its lowest 15. */
static int32_t fraction_wide(int64_t num, int64_t den) {
  FRAY_ASSERT(num > 0 && den > 0);
  const int64_t whole = fx_asr64(num, 15);
  const int64_t d = fx_asr64(den, 15);
  if (whole >= d) return YARN_SLIP_ONE;
  const unsigned bits = 64u - fx_leading_zeros64((uint64_t)d);
  const unsigned down = bits > 16u ? bits - 16u : 0u;
  const uint32_t n = (uint32_t)(down >= 15u ? whole >> (down - 15u) : whole << (15u - down));
  return fx_min((int32_t)(n / (uint32_t)(d >> down)), YARN_SLIP_ONE);
}

/* The squared length of a spring, coarse, as a divisor of 16 bits. */
typedef struct {
  int32_t whole;
  uint32_t mantissa;
  unsigned down; /* mantissa = whole >> down, 0..14 */
} slip_divisor;

static slip_divisor divisor_of(int32_t squared) {
  const unsigned bits = 32u - (unsigned)__builtin_clz((uint32_t)squared | 1u);
  const unsigned down = bits > 16u ? bits - 16u : 0u;
  const slip_divisor d = {squared, (uint32_t)squared >> down, down};
  return d;
}

/* (whole + low / 2^15) / d in Q15, clamped to 0..1. */
static int32_t fraction(int32_t whole, uint32_t low, const slip_divisor *d) {
  if (whole < 0 || d->whole == 0) return 0;
  if (whole >= d->whole) return YARN_SLIP_ONE;
  const uint32_t n = (uint32_t)whole << (15u - d->down) | low >> d->down;
  return fx_min((int32_t)(n / d->mantissa), YARN_SLIP_ONE);
}

static vec3 coarse_difference(vec3 from, vec3 to) {
  return vec_clamp(vec_round(vec_sub(to, from), COARSE_BITS), COARSE_MAX);
}

/* The living springs at a split crossing, by direction (state/yarn_grid.h): 0 and 1 of its weft, 2 and 3 of
 * its warp. */
typedef struct {
  uint32_t warp, weft;     /* particles */
  uint32_t end[4];         /* the particle at the far end of the spring, or NO_PARTICLE */
  vec3 d[4];               /* from the crossing's particle to it, coarse; 0 of NO_PARTICLE */
  slip_divisor squared[4]; /* |d|^2 */
  int32_t d_apart[4];      /* d . apart */
  vec3 apart;              /* from weft to warp, coarse */
} slip_springs;

/* Closest points of a warp spring a and a weft spring b, which begin r = apart from each other, by directions
 * (Ericson, Real-Time Collision Detection, 5.1.9): s along a, t along b, both Q15. Returns the squared gap,
 * coarse. */
__attribute__((noinline)) static int32_t closest_points(const slip_springs *springs, uint32_t warp,
                                                        uint32_t weft, int32_t *s, int32_t *t) {
  const vec3 a = springs->d[warp];
  const vec3 b = springs->d[weft];
  const slip_divisor *aa = &springs->squared[warp];
  const slip_divisor *bb = &springs->squared[weft];
  const int32_t ab = vec_dot(a, b);
  const int32_t ar = springs->d_apart[warp];
  const int32_t br = springs->d_apart[weft];
  const int64_t den = fx_mul_wide(aa->whole, bb->whole) - fx_mul_wide(ab, ab);
  *s = 0;
  if (den > 1 << 16) {
    const int64_t num = fx_mul_wide(ab, br) - fx_mul_wide(ar, bb->whole);
    *s = num <= 0 ? 0 : fraction_wide(num, den);
  }
  const int64_t along = fx_mul_wide(ab, *s) + (int64_t)br * YARN_SLIP_ONE;
  *t = fraction((int32_t)fx_asr64(along, 15), (uint32_t)along & (YARN_SLIP_ONE - 1u), bb);
  if (*t == 0 || *t == YARN_SLIP_ONE) *s = fraction((*t == 0 ? 0 : ab) - ar, 0, aa);
  const vec3 slid = vec_asr(vec_sub(vec_mul(a, *s), vec_mul(b, *t)), 15);
  const vec3 gap = vec_clamp(vec_add(springs->apart, slid), COARSE_MAX);
  return vec_dot(gap, gap);
}

/* The point on the spring between ends `first` and first + 1: 0 of the warp, 2 of the weft. */
__attribute__((noinline)) static vec3 point_on_spring(const fray_world *w, const yarn_slip_pair *pair,
                                                      uint32_t first) {
  return vec_lerp_q15(world_position(w, pair->particle[first]), world_position(w, pair->particle[first + 1u]),
                      pair->weight[first + 1u]);
}

vec3 yarn_slip_gap(const fray_world *w, const yarn_slip_pair *pair) {
  FRAY_ASSERT(pair->weight[0] + pair->weight[1] == YARN_SLIP_ONE);
  FRAY_ASSERT(pair->weight[2] + pair->weight[3] == YARN_SLIP_ONE);
  return vec_sub(point_on_spring(w, pair, 0), point_on_spring(w, pair, 2));
}

typedef struct {
  int32_t inverse_mass[4];
  int32_t fraction[4]; /* of the displacement, Q15, by which an end moves; attached: as if of half a mass */
  int32_t sum;         /* of inverse_mass b^2, Q15 */
  uint32_t last;       /* the end that compensates rounding: the one that moves most */
} slip_weights;

/* Returns 0 iff no end is free to move. */
__attribute__((noinline)) static int find_weights(const fray_world *w, const yarn_slip_pair *pair,
                                                  slip_weights *k) {
  k->sum = 0;
  k->last = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    k->inverse_mass[n] = particle_free_inverse_mass(w, pair->particle[n]);
    k->sum += k->inverse_mass[n] * fx_asr(pair->weight[n] * (pair->weight[n] / 2), 14);
    if (k->inverse_mass[n] * pair->weight[n] > k->inverse_mass[k->last] * pair->weight[k->last]) k->last = n;
  }
  if (k->sum < YARN_SLIP_ONE / 8) return 0;
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
static int32_t find_moves(const yarn_slip_pair *pair, const slip_weights *k, int32_t by, int32_t moved[4],
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
__attribute__((noinline)) static void move_axis(fray_world *w, const yarn_slip_pair *pair,
                                                const slip_weights *k, const axis_view *of, int32_t by,
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

int yarn_slip_move(fray_world *w, const yarn_slip_pair *pair, vec3 by, int keep_velocity) {
  FRAY_ASSERT(pair->weight[0] + pair->weight[1] == YARN_SLIP_ONE);
  FRAY_ASSERT(pair->weight[2] + pair->weight[3] == YARN_SLIP_ONE);
  slip_weights k;
  if (!find_weights(w, pair, &k)) return 0;
  const axis_view x = {w->p.x, w->p.qx, w->p.vx};
  const axis_view y = {w->p.y, w->p.qy, w->p.vy};
  const axis_view z = {w->p.z, w->p.qz, w->p.vz};
  move_axis(w, pair, &k, &x, by.x, 0, keep_velocity);
  move_axis(w, pair, &k, &y, by.y, 1, keep_velocity);
  move_axis(w, pair, &k, &z, by.z, 2, keep_velocity);
  return 1;
}

__attribute__((noinline)) static void find_springs(const fray_world *w, uint32_t c, slip_springs *s) {
  FRAY_ASSERT(c < w->capacity[POOL_CROSSINGS] && crossing_state_at(w, c) != FRAY_WHOLE);
  s->warp = w->woven.warp_particle[c];
  s->weft = w->woven.crossing_particle[c];
  const vec3 at[2] = {world_position(w, s->weft), world_position(w, s->warp)};
  s->apart = coarse_difference(at[0], at[1]);
  const yarn_grid_neighbours around = yarn_grid_neighbours_at(world_yarn_grid(w), c);
  for (uint32_t direction = 0; direction < 4; ++direction) {
    const uint32_t next = around.next[direction];
    const uint32_t link = around.link[direction];
    s->end[direction] = NO_PARTICLE;
    s->d[direction] = vec_make(0, 0, 0);
    if (next == c || w->woven.spring_kind[w->woven.spring_of[link]] == SPRING_DEAD) continue;
    s->end[direction] = direction < 2 ? w->woven.crossing_particle[next] : w->woven.warp_particle[next];
    s->d[direction] = coarse_difference(at[direction / 2u], world_position(w, s->end[direction]));
    s->squared[direction] = divisor_of(vec_dot(s->d[direction], s->d[direction]));
    s->d_apart[direction] = vec_dot(s->d[direction], s->apart);
  }
}

/* The closest of up to four pairs; 0 where one yarn has no spring left here. */
static int closest_pair(const slip_springs *s, yarn_slip_pair *pair) {
  int32_t closest = INT32_MAX;
  for (uint32_t warp = 2; warp < 4; ++warp)
    for (uint32_t weft = 0; weft < 2; ++weft) {
      int32_t on_warp;
      int32_t on_weft;
      if (s->end[warp] == NO_PARTICLE || s->end[weft] == NO_PARTICLE) continue;
      const int32_t squared = closest_points(s, warp, weft, &on_warp, &on_weft);
      if (squared >= closest) continue;
      closest = squared;
      pair->particle[0] = s->warp;
      pair->particle[1] = s->end[warp];
      pair->particle[2] = s->weft;
      pair->particle[3] = s->end[weft];
      pair->weight[0] = YARN_SLIP_ONE - on_warp;
      pair->weight[1] = on_warp;
      pair->weight[2] = YARN_SLIP_ONE - on_weft;
      pair->weight[3] = on_weft;
    }
  return closest != INT32_MAX;
}

int yarn_slip_closest(const fray_world *w, uint32_t crossing, yarn_slip_pair *pair) {
  FRAY_ASSERT(world_has_yarns(w) && crossing < w->capacity[POOL_CROSSINGS]);
  slip_springs springs;
  find_springs(w, crossing, &springs);
  return closest_pair(&springs, pair);
}

/* Half of b - a: the direction of a yarn through a crossing, from the springs before and after it. */
static vec3 half_difference(vec3 a, vec3 b) { return vec_asr(vec_sub(b, a), 1); }

/* The direction in which the weave puts the warp: along warp x weft or against it. */
static vec3 warp_side(const fray_world *w, const slip_springs *s, uint32_t c) {
  const vec3 a = half_difference(s->d[2], s->d[3]);
  const vec3 b = half_difference(s->d[0], s->d[1]);
  const int over = crossing_warp_over(w, c);
  return vec_cross(over ? a : b, over ? b : a);
}

/* v / |v| in Q30, v not 0; and |v|. */
__attribute__((noinline)) static vec3 unit_vector(vec3 v, uint64_t squared, int32_t *length) {
  FRAY_ASSERT(squared != 0);
  const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
  *length = (int32_t)fx_root_length(root);
  return vec_root_unit(root, v);
}

__attribute__((noinline)) static vec3 scale_unit(vec3 unit, int32_t length) {
  return vec_scale_unit(unit, length);
}

/* vec_limited() out of line: v, made shorter iff it is longer than `limit`. */
static vec3 limited(vec3 v, int32_t limit) {
  const uint64_t squared = vec_squared(v);
  int32_t length;
  if (squared <= fx_square(limit)) return v;
  return scale_unit(unit_vector(v, squared, &length), limit);
}

/* The displacement of a particle in this substep, Q24 lu: its step, and what projections have added. */
__attribute__((noinline)) static vec3 displacement(const fray_world *w, uint32_t p) {
  const vec3 since = vec_sub(world_position(w, p), vec_at(w->p.qx, w->p.qy, w->p.qz, p));
  return vec_add(vec_round(world_velocity(w, p), FX_SUB_BITS), since);
}

/* The slip at the closest points that friction removes; pressed: length of the correction that separates
 * them. */
static vec3 friction(const fray_world *w, const yarn_slip_pair *pair, vec3 normal, int32_t pressed) {
  FRAY_ASSERT(pressed >= 0);
  vec64 sum = {0, 0, 0};
  for (uint32_t n = 0; n < 4; ++n) {
    const int32_t b = n < 2 ? pair->weight[n] : -pair->weight[n];
    sum = vec_add64(sum, vec_scale64(displacement(w, pair->particle[n]), b));
  }
  const vec3 relative = vec_round_saturated(sum, 15);
  const vec3 slip = vec_sub(relative, scale_unit(normal, vec_dot_unit(relative, normal)));
  return limited(slip, coulomb_limit(pressed, w->woven.yarn_constants->slip_friction,
                                     w->woven.yarn_constants->crossing_friction));
}

/* 1 iff the warp is on the wrong side of the weft. Only where both yarns go on in both directions and cross
 * at more than 30 degrees: the end of a yarn may lie on either side of the other yarn. */
static int is_through(const slip_springs *s, vec3 gap, vec3 side) {
  if (vec_dot64(gap, side) >= 0) return 0;
  for (uint32_t direction = 0; direction < 4; ++direction)
    if (s->end[direction] == NO_PARTICLE) return 0;
  const vec3 a = half_difference(s->d[2], s->d[3]);
  const vec3 b = half_difference(s->d[0], s->d[1]);
  return vec_squared(side) / 4u > (uint64_t)fx_mul_wide(vec_dot(a, a) / 4, vec_dot(b, b) / 4);
}

void yarn_slip_crossing(fray_world *w, uint32_t c) {
  FRAY_ASSERT(crossing_state_at(w, c) == FRAY_LOOSE);
  yarn_slip_pair pair;
  slip_springs springs;
  find_springs(w, c, &springs);
  if (!closest_pair(&springs, &pair)) return;
  const int32_t thickness = w->params->thickness;
  const vec3 gap = yarn_slip_gap(w, &pair);
  const uint64_t gap_squared = vec_squared(gap);
  const vec3 side = warp_side(w, &springs, c);
  const int32_t by_max = thickness / 4;
  const int touching = gap_squared < fx_square(thickness / 16 + 1); /* too close for a normal of the gap */
  const vec3 from = touching ? side : gap;
  const uint64_t squared = touching ? vec_squared(side) : gap_squared;
  if (squared == 0) return;
  int32_t length;
  const vec3 normal = unit_vector(from, squared, &length);
  const int through = !touching && is_through(&springs, gap, side);
  const int keep_velocity = touching || through;
  const int32_t by = touching ? by_max : through ? -by_max : fx_clamp(thickness - length, -by_max, by_max);
  vec3 correction = scale_unit(normal, by);
  const yarn_params *yarns = w->woven.yarn_constants;
  if (!keep_velocity && (yarns->slip_friction | yarns->crossing_friction) != 0)
    correction = vec_sub(correction, friction(w, &pair, normal, (int32_t)fx_magnitude(by)));
  yarn_slip_move(w, &pair, correction, keep_velocity);
}

/* Connected crossings of all-yarn cloth (section 6): warp and weft particle are bound, a thickness apart. */
__attribute__((noinline)) static void bind_particles(fray_world *w, uint32_t c) {
  slip_springs springs;
  find_springs(w, c, &springs);
  const yarn_slip_pair pair = {{springs.warp, springs.warp, springs.weft, springs.weft},
                               {YARN_SLIP_ONE, 0, YARN_SLIP_ONE, 0}};
  const vec3 side = warp_side(w, &springs, c);
  const uint64_t squared = vec_squared(side);
  if (squared == 0) return;
  int32_t length;
  const vec3 wanted_gap = scale_unit(unit_vector(side, squared, &length), w->params->thickness);
  const vec3 by = vec_sub(wanted_gap, yarn_slip_gap(w, &pair));
  yarn_slip_move(w, &pair, limited(by, w->params->thickness), 0);
}

/* Lists the crossings that slip in this tick, by colour: split ones that are not disconnected. */
__attribute__((noinline)) static void find_slipping(fray_world *w) {
  const uint32_t warps = (uint32_t)w->params->warps;
  for (uint32_t n = 0; n < SLIP_COLOURS; ++n) w->woven.slip_head[n] = SLIP_LIST_END;
  for (uint32_t p = (uint32_t)w->params->particles; p < w->p.count; ++p) {
    const uint32_t c = w->woven.crossing_of[p];
    FRAY_ASSERT(c < w->capacity[POOL_CROSSINGS] && crossing_state_at(w, c) != FRAY_WHOLE);
    if (crossing_state_at(w, c) == FRAY_DISCONNECTED) continue;
    uint32_t *head = &w->woven.slip_head[(c - c / warps * (warps - 2u)) % SLIP_COLOURS];
    w->woven.slip_next[c] = (index_t)*head;
    *head = c;
  }
}

void yarn_slip_apply(fray_world *w, uint32_t substep) {
  FRAY_ASSERT(world_has_yarns(w));
  FRAY_ASSERT(substep < (uint32_t)w->params->substeps);
  if (substep == 0) {
    find_slipping(w);
#if SLIP_LISTED
    yarn_slip_list_fill(w);
#endif
  }
  for (uint32_t n = 0; n < SLIP_COLOURS; ++n) {
#if SLIP_LISTED
    yarn_slip_list_solve(w, n);
#endif
    for (uint32_t c = w->woven.slip_head[n]; c != SLIP_LIST_END; c = w->woven.slip_next[c]) {
      if (crossing_state_at(w, c) == FRAY_LOOSE)
        yarn_slip_crossing(w, c);
      else
        bind_particles(w, c);
      ++w->work.slips;
    }
  }
}
