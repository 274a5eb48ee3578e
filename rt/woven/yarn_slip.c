/* SPDX-License-Identifier: Apache-2.0 */
/* The yarns of a split crossing slide over each other. Their contact has a place on each, u on the warp and
 * v on the weft (yarn_curve.h), which goes from link to link, and keeps the two yarns together there:
 *
 *   g = x_warp(u) - x_weft(v) - offset;  k g on the weft, -k g on the warp, k = kappa (m / 2) / h^2
 *
 * A central force of equal and opposite parts, so momentum is exact and moments are kept to rounding.
 * Both ways: yarns do not lift off each other.
 *
 * Friction: along each yarn, of direction d, the contact holds no more than its limit (yarn_grip.c). What is
 * above it slides the place, by
 *
 *   du = -(|e| - limit / k) sign(e) / |d|,  e = g . d / |d|
 *
 * which takes from g^2 and so from what the contact stores; |d| is taken as the spacing, so no root is
 * needed. The warp slides first, the weft by what that left: both at once gain energy where yarns are
 * nearly parallel. Order along a yarn is a spring of the same stiffness between places nearer than half a
 * spacing: a potential of places alone, so that no particle feels it. It hands the load on to the next
 * crossings.
 *
 * Energy, projected yarns: the impulse changes velocities by as much as the yarns part, so no contact makes
 * any. What the gap asks for beyond that moves positions alone.
 * Elastic yarns: the contact is a spring and stores k g^2 / 2. g is that of where particles would be when
 * contacts act next, which damps it. A slide only takes from what is stored.
 *
 * A contact that slides off a yarn's end, or past a break, leaves at once: its force does not come back.
 * What follows for its crossing comes at the end of the tick (crossing_transition.c).
 *
 * All contacts are found from the positions and places at the beginning of the pass, then all are applied,
 * so their order does not matter. Projections come before: what they did shows as gap. */
#include "rt/woven/yarn_slip.h"

#include "rt/energy/energy.h"
#include "rt/woven/woven.h"

enum {
  SLIDE_MAX = YARN_PLACE_ONE / 4,
  NEAR_STEP = YARN_SLIP_NEAR + YARN_PLACE_ONE / 20, /* places nearer than that slide a fifth of their way */
  NEAREST = YARN_PLACE_ONE / 10, /* of the room down to this each of two neighbours takes half at most */
  FAR = 4 * YARN_PLACE_ONE,     /* neighbours beyond it are as good as there */
  FIFTH = 13107,                 /* Q16 */
  INVERSE_BITS = 42
};

/* Of a pass: by fray_axis 2^INVERSE_BITS / R^2, where R is the spacing in units of 2^LINK_SHIFT. */
typedef struct {
  int32_t inverse[2];
} slip_gains;

static yarn_line line_of(const fray_world *w, uint32_t n, uint32_t axis) {
  return yarn_line_of(w, axis, w->woven.contact_steps[n].number[axis]);
}

static int spot_at(const fray_world *w, uint32_t n, uint32_t axis, uint32_t place, yarn_touch *touch) {
  const yarn_line line = line_of(w, n, axis);
  return yarn_spot_at(w, &line, place, &touch->spot[axis]);
}

static int touch_at(const fray_world *w, uint32_t n, const uint32_t place[2], yarn_touch *touch) {
  for (uint32_t axis = 0; axis < 2; ++axis)
    if (!spot_at(w, n, axis, place[axis], touch)) return 0;
  touch->gap = yarn_touch_gap(touch, &w->woven.contacts[n]);
  return 1;
}

int32_t yarn_slip_distance(const fray_world *w, uint32_t n, uint32_t direction) {
  const index_t neighbour = w->woven.contact_steps[n].neighbour[direction];
  const uint32_t axis = direction / 2u;
  const uint32_t place = w->woven.contacts[n].place[axis];
  const int on = (direction & 1u) != 0;
  if (neighbour == YARN_NEIGHBOUR_NONE) return FAR;
  const int whole = (neighbour & YARN_NEIGHBOUR_WHOLE) != 0;
  const uint32_t k = neighbour & (index_t)~YARN_NEIGHBOUR_WHOLE;
  const uint32_t other = whole ? yarn_place_of(k) : w->woven.contacts[k].place[axis];
  const uint32_t from = on ? place : other;
  const uint32_t to = on ? other : place;
  if (to <= from) return 0;
  return to - from < (uint32_t)FAR ? (int32_t)(to - from) : FAR;
}

/* By how much the place on a yarn slides, Q20 spacings; pull: what the gap asks for. */
static int32_t slide_of(const fray_world *w, uint32_t n, uint32_t axis, int32_t pull) {
  const yarn_contact_step *t = &w->woven.contact_steps[n];
  const int32_t behind = yarn_slip_distance(w, n, 2u * axis);
  const int32_t ahead = yarn_slip_distance(w, n, 2u * axis + 1u);
  const int32_t drive =
      pull - fx_max(YARN_SLIP_NEAR - ahead, 0) + fx_max(YARN_SLIP_NEAR - behind, 0);
  const int32_t over = (int32_t)fx_magnitude(drive) - t->limit[axis];
  if (over <= 0) return 0;
  const int32_t room = ((drive > 0 ? ahead : behind) - NEAREST) / 2;
  const int is_near = ahead < NEAR_STEP || behind < NEAR_STEP;
  const int32_t wanted = is_near ? (int32_t)(fx_mul_wide(over, FIFTH) >> 16) : over;
  const int32_t by = fx_max(fx_min(fx_min(wanted, SLIDE_MAX), room), 0);
  return drive > 0 ? by : -by;
}

/* g . d / |d|^2 in Q20 spacings: what slides until the contact has no force along the yarn. */
static int32_t pull_along(const slip_gains *k, const yarn_touch *touch, uint32_t axis) {
  const vec3 along = vec_clamp(touch->spot[axis].along, YARN_GAP_MAX);
  const int32_t dot = (int32_t)fx_round64(vec_dot64(touch->gap, along), 16);
  const int32_t pull = fx_mul_round(dot, k->inverse[axis], INVERSE_BITS - YARN_PLACE_BITS);
  return axis == (uint32_t)FRAY_WARP ? -pull : pull;
}

/* Slides along one yarn. Returns 0 iff the contact leaves. */
static int slide_along(const fray_world *w, const slip_gains *k, uint32_t n, uint32_t axis,
                       yarn_touch *touch) {
  yarn_contact_step *t = &w->woven.contact_steps[n];
  const yarn_spot *spot = &touch->spot[axis];
  const int32_t by = slide_of(w, n, axis, pull_along(k, touch, axis));
  if (by == 0) return 1;
  const int32_t past = yarn_place_past(t->next[axis]) + by;
  if (past < -YARN_PLACE_BEYOND && (spot->goes & YARN_GOES_BACK) == 0) return 0;
  if (past > YARN_PLACE_BEYOND && (spot->goes & YARN_GOES_ON) == 0) return 0;
  t->next[axis] = yarn_place_moved(t->next[axis], by);
  if (!spot_at(w, n, axis, t->next[axis], touch)) return 0;
  touch->gap = yarn_touch_gap(touch, &w->woven.contacts[n]);
  return 1;
}

/* What a particle has moved in this substep, Q24 lu: by its velocity and by projections. */
static vec3 displacement(const fray_world *w, uint32_t p) {
  const vec3 since = vec_sub(world_position(w, p), vec_at(w->p.qx, w->p.qy, w->p.qz, p));
  return vec_clamp_rare(vec_add(vec_round(world_velocity(w, p), FX_SUB_BITS), since), YARN_GAP_MAX);
}

/* The middle one's weight is what the two others leave. */
static int32_t middle_weight(const yarn_spot *spot) {
  return YARN_PLACE_ONE - spot->weight[0] - spot->weight[1];
}

/* Of one yarn along the gap: how far it moved in this substep, and by how much an impulse moves it. */
typedef struct {
  int64_t moved; /* of along . displacement / 2^8, Q20 */
  int32_t gives; /* sum of b^2 by inverse masses, Q20: 1 for half a crossing's mass */
} slip_motion;

static slip_motion motion_at(const fray_world *w, const yarn_spot *spot, vec3 along) {
  const int32_t b[3] = {spot->weight[0], middle_weight(spot), spot->weight[1]};
  slip_motion m = {0, 0};
  for (uint32_t n = 0; n < 3; ++n) {
    const uint32_t p = spot->particle[n];
    if (b[n] == 0) continue;
    m.moved += fx_mul_wide((int32_t)fx_asr64(vec_dot64(along, displacement(w, p)), 8), b[n]);
    m.gives += fx_mul_round(b[n], b[n], YARN_PLACE_BITS + 1) * particle_free_inverse_mass(w, p);
  }
  return m;
}

/* v in 14 bits: its direction, for products that fit. */
static vec3 coarse_direction(vec3 v) {
  const int bits = 32 - __builtin_clz(vec_span(v) | 1u);
  return bits > 14 ? vec_asr(v, (unsigned)(bits - 14)) : vec_mul(v, 1 << (14 - bits));
}

/* The part of the impulse, Q15, that may change velocities: as much as stops projected yarns from parting. */
static int32_t braking_part(const fray_world *w, const yarn_touch *touch) {
  const vec3 along = coarse_direction(touch->gap);
  const slip_motion warp = motion_at(w, &touch->spot[FRAY_WARP], along);
  const slip_motion weft = motion_at(w, &touch->spot[FRAY_WEFT], along);
  const int64_t parting = warp.moved - weft.moved;
  const int32_t given = fx_mul_round(warp.gives + weft.gives, YARN_SLIP_KAPPA, YARN_SLIP_KAPPA_BITS);
  const int64_t stops = fx_mul_wide((int32_t)fx_asr64(vec_dot64(along, touch->gap), 8), given);
  if (parting <= 0) return 0;
  if (parting >= stops) return 1 << 15;
  const unsigned bits = 64u - fx_leading_zeros64((uint64_t)stops);
  const unsigned down = bits > 31u ? bits - 31u : 0u;
  return (int32_t)fx_divide_wide((uint64_t)(parting >> down) << 15, (uint32_t)(stops >> down));
}

/* Impulses of elastic yarns are in Q28 velocities of half a crossing: in whole position steps a tenth of a
 * gap is mostly rounding, which keeps cloth at rest moving by a millimetre a second. */
static unsigned impulse_bits(const fray_world *w) {
  return world_has_elastic_yarns(w) ? FX_SUB_BITS - 1u + yarn_slip_bits(w) : 0u;
}

/* Slides of both yarns. Returns 0 iff the contact leaves. */
static int slide(fray_world *w, const slip_gains *k, uint32_t n, yarn_touch *touch) {
  const vec3 before = touch->gap;
  if (!slide_along(w, k, n, FRAY_WARP, touch) || !slide_along(w, k, n, FRAY_WEFT, touch)) return 0;
  if (world_has_elastic_yarns(w)) energy_slide(w, vec_sub(touch->gap, before));
  return 1;
}

static void find_impulse(fray_world *w, const slip_gains *k, uint32_t n) {
  yarn_contact_step *t = &w->woven.contact_steps[n];
  const uint32_t c = yarn_contact_crossing(w, n);
  yarn_touch touch;
  t->next[FRAY_WEFT] = w->woven.contacts[n].place[FRAY_WEFT];
  t->next[FRAY_WARP] = w->woven.contacts[n].place[FRAY_WARP];
  int stays = touch_at(w, n, t->next, &touch);
  if (stays && crossing_state_at(w, c) == FRAY_LOOSE) stays = slide(w, k, n, &touch);
  if (!stays) {
    crossing_set_left(w, c);
    return;
  }
  const vec3 asked = vec_round_saturated(vec_scale64(touch.gap, yarn_slip_kappa(w)),
                                         YARN_SLIP_KAPPA_BITS - impulse_bits(w));
  const vec3 braking = world_has_elastic_yarns(w) ? asked : vec_scale_q15(asked, braking_part(w, &touch));
  vec_store(t->impulse, braking);
  vec_store(t->quiet, vec_sub(asked, braking));
}

/* One component of a particle of projected yarns; `half` in half crossings x Q24 lu. What is no whole step of
 * a whole one goes to its velocity. */
static void push_axis(int32_t *x, int32_t *v, int32_t inverse_mass, int32_t unit, int32_t half) {
  const int32_t step = inverse_mass == 2 ? half : half / 2;
  const int32_t rest = inverse_mass == 2 ? half - step : half - 2 * step;
  *x = fx_add(*x, step);
  if (rest != 0) *v = fx_add_saturated(*v, rest * inverse_mass * unit);
}

static void add_impulse(fray_world *w, uint32_t p, vec3 half) {
  const int32_t inverse_mass = particle_free_inverse_mass(w, p);
  const int32_t unit = 1 << (FX_SUB_BITS - 1 + yarn_slip_bits(w) - impulse_bits(w)); /* of momentum, Q28 */
  if (inverse_mass == 0) {
    body_add_impulse(&w->rigid.motion[w->p.attach_body[p]], vec_scale64(half, -unit));
    return;
  }
  if (world_has_elastic_yarns(w)) { /* which move by velocities alone */
    world_set_velocity(w, p, vec_add_clamped(world_velocity(w, p), vec_mul(half, inverse_mass), INT32_MAX));
    return;
  }
  push_axis(&w->p.x[p], &w->p.vx[p], inverse_mass, unit, half.x);
  push_axis(&w->p.y[p], &w->p.vy[p], inverse_mass, unit, half.y);
  push_axis(&w->p.z[p], &w->p.vz[p], inverse_mass, unit, half.z);
}

/* As far as add_impulse() would, with its predicted position. */
static void move_particle(fray_world *w, uint32_t p, vec3 half) {
  const int32_t inverse_mass = particle_free_inverse_mass(w, p);
  const vec3 by = inverse_mass == 2 ? half : vec_round(half, 1);
  if (inverse_mass == 0) return;
  vec_add_at(w->p.x, w->p.y, w->p.z, p, by);
  vec_add_at(w->p.qx, w->p.qy, w->p.qz, p, by);
}

static vec3 share_of(vec3 v, int32_t weight) {
  return vec_make(fx_mul_round(v.x, weight, YARN_PLACE_BITS), fx_mul_round(v.y, weight, YARN_PLACE_BITS),
                  fx_mul_round(v.z, weight, YARN_PLACE_BITS));
}

/* half: of the yarn, which changes its momentum; quiet: what does not. */
static void push_yarn(fray_world *w, uint32_t n, uint32_t axis, vec3 half, vec3 quiet) {
  const yarn_line line = line_of(w, n, axis);
  yarn_spot spot;
  if (!yarn_spot_find(w, &line, w->woven.contacts[n].place[axis], &spot)) return;
  const vec3 before = share_of(half, spot.weight[0]);
  const vec3 after = share_of(half, spot.weight[1]);
  if (spot.weight[0] != 0) add_impulse(w, spot.particle[0], before);
  add_impulse(w, spot.particle[1], vec_sub(vec_sub(half, before), after));
  if (spot.weight[1] != 0) add_impulse(w, spot.particle[2], after);
  if (vec_span(quiet) == 0) return;
  if (spot.weight[0] != 0) move_particle(w, spot.particle[0], share_of(quiet, spot.weight[0]));
  move_particle(w, spot.particle[1], share_of(quiet, middle_weight(&spot)));
  if (spot.weight[1] != 0) move_particle(w, spot.particle[2], share_of(quiet, spot.weight[1]));
}

static void apply_slide(fray_world *w, uint32_t n) {
  const yarn_contact_step *t = &w->woven.contact_steps[n];
  yarn_contact *c = &w->woven.contacts[n];
  for (uint32_t axis = 0; axis < 2; ++axis) {
    if (c->place[axis] != t->next[axis]) c->grip |= 1u << axis;
    c->place[axis] = t->next[axis];
  }
  ++w->work.slips;
}

static void apply_impulse(fray_world *w, uint32_t n) {
  const yarn_contact_step *t = &w->woven.contact_steps[n];
  const vec3 half = vec_of(t->impulse);
  const vec3 quiet = vec_of(t->quiet);
  push_yarn(w, n, FRAY_WEFT, half, quiet);
  push_yarn(w, n, FRAY_WARP, vec_negated(half), vec_negated(quiet));
}

static int32_t inverse_of(const fray_world *w, uint32_t class) {
  return (int32_t)fx_divide_wide((uint64_t)1 << INVERSE_BITS, (uint32_t)w->woven.link_classes[class].r2);
}

void yarn_slip_apply(fray_world *w) {
  FRAY_ASSERT(world_has_yarns(w));
  const uint32_t contacts = (uint32_t)w->woven.yarn_counts->split;
  const slip_gains k = {{inverse_of(w, CLASS_WEFT), inverse_of(w, CLASS_WARP)}};
  for (uint32_t found = 0; found < contacts; ++found)
    if (yarn_contact_acts(w, found)) find_impulse(w, &k, found);
  if (world_has_elastic_yarns(w)) energy_slides_found(w);
  for (uint32_t slid = 0; slid < contacts; ++slid)
    if (yarn_contact_acts(w, slid)) apply_slide(w, slid);
  if (world_has_elastic_yarns(w)) energy_slides_made(w);
  for (uint32_t n = 0; n < contacts; ++n)
    if (yarn_contact_acts(w, n)) apply_impulse(w, n);
}
