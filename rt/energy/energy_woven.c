/* SPDX-License-Identifier: Apache-2.0 */
/* Elastic energies of woven cloth. Bend and shear springs and elastic yarns pull with k f(x) d, of a
 * difference d as long as l, with r the length at rest and x = l^2 / r^2 - 1: their energy is k r^2 / 2 times
 * the integral of f, the polynomial that stages have for 1 - r/l; beyond its ends it stays. With (l - r)^2 in
 * its place springs that contact puts back in every tick made 0.3 % of their work.
 * Yarns without a stiffness are projected and store nothing. Contacts of elastic yarns are springs as well.
 *
 * Bend and shear springs give the impulse k (1 - r/l) d of S substeps at once: their energy is that over S,
 * and their part of form v.J / 2, as before they act, at the places where v leads until they act again. So
 * nothing changes when they act, nor while v stays, and what a stage changes in v is that stage's. That of
 * yarns is v.J / 2 of an elastic step. J of a yarn is held along each axis (woven/yarn_stretch.c), and what
 * it lacks is not stored. */
#include "rt/energy/energy_measure.h"
#include "rt/state/crossing.h"
#include "rt/state/yarn_touch.h"

#if FRAY_ENERGY

enum { FACTOR_BITS = 30, FACTOR_ONE = 1 << FACTOR_BITS, SERIES = 5 };

/* k is mantissa 2^-shift; f is x times a polynomial, for x from least to most, all Q30. */
typedef struct {
  int64_t mantissa;
  unsigned shift;
  int32_t rest, least, most;
  int32_t series[SERIES];
  int is_held; /* its impulse, at YARN_ELASTIC_IMPULSE_MAX along an axis */
} spring_law;

/* Of springs so far: energy, and velocity times impulse. */
typedef struct {
  wide_number energy, power;
} spring_sums;

/* The integral of f from 0, and f. */
typedef struct {
  wide_number stored;
  int64_t factor;
} spring_state;

/* Q30 of l^2 / r^2 - 1, below 2^20. */
static int64_t elongation_of(const spring_law *law, uint64_t squared) {
  enum { ROOM_BITS = 33, MOST = 1 << 20 };
  uint64_t at_rest = fx_square(law->rest);
  uint64_t now = squared;
  for (; at_rest >> ROOM_BITS != 0; at_rest >>= 1) now >>= 1;
  const int64_t whole = fx_clamp64((int64_t)(now / at_rest), 0, MOST);
  const int64_t part = (int64_t)((now % at_rest << FACTOR_BITS) / at_rest);
  return (whole - 1) * FACTOR_ONE + part;
}

/* A polynomial of x, or that of its integral over x^2. */
static int64_t polynomial(const spring_law *law, int64_t x, int is_integral) {
  int64_t sum = 0;
  for (int32_t n = SERIES; n-- > 0;) {
    const int64_t term = is_integral ? law->series[n] / (n + 2) : law->series[n];
    sum = term + fx_asr64(sum * x, FACTOR_BITS);
  }
  return sum;
}

/* The integral from 0 to x. */
static wide_number integral_within(const spring_law *law, int64_t x) {
  return wide_product(x * x, polynomial(law, x, 1), 3u * FACTOR_BITS);
}

/* What it is below -1/2 without half of the integral to 4 x + 3. */
static wide_number integral_below(const spring_law *law, int64_t x) {
  const wide_number upper = wide_shift_down(integral_within(law, FACTOR_ONE), 1);
  const wide_number lower = integral_within(law, -FACTOR_ONE / 2);
  return wide_sub(wide_sub(lower, upper), wide_of(x + FACTOR_ONE / 2, FACTOR_BITS));
}

/* Below half of r^2 f is 2 f(4 l^2 / r^2 - 1) - 1. */
static spring_state state_of(const spring_law *law, uint64_t squared) {
  const int64_t elongation = elongation_of(law, squared);
  const int64_t held = fx_clamp64(elongation, law->least, law->most);
  wide_number stored = {0, 0};
  unsigned halves = 0;
  int64_t x = held;
  for (; x < -FACTOR_ONE / 2; x = 4 * x + (int64_t)3 * FACTOR_ONE) {
    stored = wide_add(stored, wide_shift_down(integral_below(law, x), halves));
    ++halves;
  }
  const int64_t within = fx_asr64(polynomial(law, x, 0) * x, FACTOR_BITS);
  const int64_t factor = FACTOR_ONE - (FACTOR_ONE - within) * ((int64_t)1 << halves);
  stored = wide_add(stored, wide_shift_down(integral_within(law, x), halves));
  stored = wide_add(stored, wide_product(elongation - held, factor, 2u * FACTOR_BITS));
  const spring_state s = {stored, factor};
  return s;
}

/* Where its velocity leads in so many moves. */
static vec3 position_ahead(const fray_world *w, uint32_t p, int32_t moves) {
  const unsigned bits = world_has_elastic_yarns(w) ? (unsigned)w->woven.elastic_params->steps_bits : 0;
  const vec3 at = world_position(w, p);
  if (moves == 0) return at;
  const vec3 v = particle_is_attached(w, p) ? vec_of(w->rigid.states[w->p.attach_body[p]].velocity)
                                            : energy_velocity(w, p);
  const vec3 way = vec_round_saturated(vec_scale64(v, moves), FX_SUB_BITS + bits);
  return vec_add_clamped(at, way, 2 * FX_WORLD_MAX);
}

static vec3 apart_ahead(const fray_world *w, uint32_t i, uint32_t j, int32_t moves) {
  return vec_sub_clamped(position_ahead(w, j, moves), position_ahead(w, i, moves), 1 << 29);
}

static vec64 velocity_of(const fray_world *w, uint32_t p) {
  if (particle_is_attached(w, p)) {
    const vec64 nothing = {0, 0, 0}; /* a body's comes by pull */
    return nothing;
  }
  const vec3 v = energy_velocity(w, p);
  const vec64 wider = {v.x, v.y, v.z};
  return wider;
}

/* Holds the impulse J = k f d along an axis at M; returns the energy that it lacks, (J - M)^2 / (2 k f). */
static wide_number hold(wide_number *impulse, int32_t d) {
  enum { BITS = 40, MOST_SHIFT = BITS - FX_VELOCITY_BITS, SHARE_BITS = 30 };
  const int64_t most = (int64_t)YARN_ELASTIC_IMPULSE_MAX << MOST_SHIFT;
  const int64_t given = wide_rounded(*impulse, BITS);
  const int64_t size = given < 0 ? -given : given;
  const wide_number nothing = {0, 0};
  if (size <= most) return nothing;
  *impulse = wide_of(given < 0 ? -most : most, BITS);
  const int64_t excess = size - most;
  const int64_t share = (excess << (SHARE_BITS - 16)) / (size >> 16);
  const int64_t length = d < 0 ? -(int64_t)d : d;
  return wide_times(wide_product(excess, length, BITS + FX_POSITION_BITS), share, SHARE_BITS + 1);
}

/* End i of d gets the impulse k (1 - r/l) d, end j the opposite. */
static void add_spring(const fray_world *w, const spring_law *law, uint32_t i, uint32_t j, vec3 d,
                       spring_sums *sums, energy_stored *e) {
  const spring_state s = state_of(law, vec_squared(d));
  const vec64 a = velocity_of(w, i);
  const vec64 b = velocity_of(w, j);
  const int64_t apart[3] = {a.x - b.x, a.y - b.y, a.z - b.z};
  const int32_t along[3] = {d.x, d.y, d.z};
  const int holds = particle_is_attached(w, i) || particle_is_attached(w, j);
  const wide_number stored = wide_times(s.stored, (int64_t)fx_square(law->rest), 2u * FX_POSITION_BITS + 1u);
  sums->energy = wide_add(sums->energy, wide_times(stored, law->mantissa, law->shift));
  for (uint32_t n = 0; n < 3; ++n) {
    const wide_number force = wide_product(along[n], s.factor, FX_POSITION_BITS + FACTOR_BITS);
    wide_number impulse = wide_times(force, law->mantissa, law->shift);
    if (law->is_held) sums->energy = wide_sub(sums->energy, hold(&impulse, along[n]));
    sums->power = wide_add(sums->power, wide_times(impulse, apart[n], FX_VELOCITY_BITS));
    if (!holds) continue;
    wide_number *pull = &e->pull[w->p.attach_body[particle_is_attached(w, i) ? i : j]][n];
    *pull = particle_is_attached(w, i) ? wide_add(*pull, impulse) : wide_sub(*pull, impulse);
  }
}

static int is_inactive(const fray_world *w, uint32_t spring) {
  return w->woven.spring_kind[spring] == SPRING_DEAD ||
         (particle_is_attached(w, w->woven.spring_i[spring]) &&
          particle_is_attached(w, w->woven.spring_j[spring]));
}

static void add_bend_shear(const fray_world *w, uint32_t first, uint32_t end, spring_sums *sums,
                           energy_stored *e) {
  enum { LEAST = -(1 << 30) / 32 * 31, MOST = 1 << 30, UP = 1 << 16 }; /* bend_shear.c's bounds of t */
  const int32_t ahead = energy_spring_moves(w) - w->energy.passed;
  FRAY_ASSERT(first <= end && end <= w->capacity[POOL_SPRINGS]);
  for (uint32_t n = first; n < end; ++n) {
    if (is_inactive(w, n)) continue;
    const bend_shear_class *c =
        &w->woven.bend_shear_classes[w->woven.spring_kind[n] & SPRING_CLASS];
    const uint32_t i = w->woven.spring_i[n];
    const uint32_t j = w->woven.spring_j[n];
    const spring_law law = {c->mantissa, (unsigned)c->shift, c->rest, LEAST, MOST,
                            {BEND_SHEAR_SERIES_1 * UP, BEND_SHEAR_SERIES_2 * UP, BEND_SHEAR_SERIES_3 * UP,
                             BEND_SHEAR_SERIES_4 * UP, 0},
                            0};
    const vec3 d = apart_ahead(w, i, j, ahead);
    if (c->compression_only == 0 || vec_squared(d) < fx_square(c->rest))
      add_spring(w, &law, i, j, d, sums, e);
  }
}

static void measure_bend_shear(const fray_world *w, energy_stored *e) {
  const uint32_t links = (uint32_t)w->params->links;
  const uint32_t bends = (uint32_t)w->params->bends;
  const wide_number nothing = {0, 0};
  spring_sums bend = {nothing, nothing};
  spring_sums shear = {nothing, nothing};
  add_bend_shear(w, links, links + bends, &bend, e);
  add_bend_shear(w, links + bends, w->capacity[POOL_SPRINGS], &shear, e);
  e->bend = wide_over(bend.energy, (uint32_t)energy_spring_substeps(w));
  e->shear = wide_over(shear.energy, (uint32_t)energy_spring_substeps(w));
  e->form = wide_shift_down(wide_add(bend.power, shear.power), 1);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    for (uint32_t n = 0; n < 3; ++n) e->pull[b][n] = wide_shift_down(e->pull[b][n], 1);
}

static void measure_yarns(const fray_world *w, energy_stored *e) {
  enum { LEAST = -(1 << 30) / 16 * 7, MOST = (1 << 30) / 16 * 9 }; /* yarn_stretch.c's bounds of u */
  const unsigned steps_bits = (unsigned)w->woven.elastic_params->steps_bits;
  const wide_number nothing = {0, 0};
  spring_sums sums = {nothing, nothing};
  energy_stored held; /* of yarns alone */
  for (uint32_t b = 0; b < MAX_BODIES; ++b)
    for (uint32_t n = 0; n < 3; ++n) held.pull[b][n] = nothing;
  for (uint32_t n = 0; n < (uint32_t)w->params->links; ++n) {
    if (is_inactive(w, n)) continue;
    const uint32_t class = w->woven.spring_kind[n] & SPRING_CLASS;
    const link_class *c = &w->woven.link_classes[class];
    const yarn_gain *k = &w->woven.yarn_gains[class];
    const uint32_t i = w->woven.spring_i[n];
    const uint32_t j = w->woven.spring_j[n];
    const vec3 d = apart_ahead(w, i, j, 0);
    const int longer = vec_squared(d) >= fx_square(c->rest);
    const spring_law law = {(int64_t)(longer ? k->pull : k->push) * c->r2,
                            (unsigned)(longer ? k->pull_scale : k->push_scale) + 28u, c->rest, LEAST, MOST,
                            {STRETCH_PHI_0 * 4, STRETCH_PHI_1 * 4, STRETCH_PHI_2 * 4, STRETCH_PHI_3 * 4,
                             STRETCH_PHI_4 * 4},
                            1};
    add_spring(w, &law, i, j, d, &sums, &held);
  }
  e->yarns = wide_shift_up(sums.energy, steps_bits);
  const int64_t sign = w->energy.pulled ? -1 : 1;
  e->form = wide_add(e->form, wide_times(sums.power, sign, 1));
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    for (uint32_t n = 0; n < 3; ++n)
      e->pull[b][n] = wide_add(e->pull[b][n], wide_times(held.pull[b][n], sign, 1));
}

/* k g^2 / 2, k = kappa (m / 2) / h^2, h the time between passes. */
wide_number energy_of_contact(const fray_world *w, vec3 gap) {
  const wide_number half = wide_product((int64_t)vec_squared(gap), yarn_slip_kappa(w),
                                        2u * FX_POSITION_BITS + YARN_SLIP_KAPPA_BITS + 2u);
  return wide_shift_up(half, 2u * yarn_slip_bits(w));
}

static void measure_contacts(const fray_world *w, energy_stored *e) {
  wide_number sum = {0, 0};
  for (uint32_t n = 0; n < (uint32_t)w->woven.yarn_counts->split; ++n) {
    yarn_touch touch;
    if (!yarn_contact_acts(w, n) || !yarn_touch_at(w, n, &touch)) continue;
    sum = wide_add(sum, energy_of_contact(w, touch.gap));
  }
  e->yarns = wide_add(e->yarns, sum);
}

void energy_measure_woven(const fray_world *w, energy_stored *e) {
  FRAY_ASSERT(!world_has_membrane(w) && w->energy.passed >= 0 &&
              w->energy.passed <= energy_spring_moves(w));
  const wide_number nothing = {0, 0};
  e->stretch = e->yarns = nothing;
  for (uint32_t b = 0; b < MAX_BODIES; ++b)
    for (uint32_t n = 0; n < 3; ++n) e->pull[b][n] = nothing;
  measure_bend_shear(w, e);
  if (world_has_elastic_yarns(w)) measure_yarns(w, e);
  if (world_has_elastic_yarns(w) && world_has_yarns(w)) measure_contacts(w, e);
}

#endif
