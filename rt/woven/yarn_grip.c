/* SPDX-License-Identifier: Apache-2.0 */
/* What holds the contacts of yarns, once a tick: their neighbours along both yarns, and the limit of friction
 * along each,
 *
 *   grip w + mu (N + |k g across the yarn|)
 *
 * grip is the scene's crossing_friction, mu its slip_friction. w: the fraction of the four sides on which the
 * next crossing of a yarn lies on its other side, or there is none, at least 1/32. N presses the yarns:
 *
 *   N = sum of T / d over the sides on which the next crossing lies on the other side * Tw Tf / (Tw + Tf)
 *
 * with the thickness T, the distance d to that crossing and the tensions Tw and Tf: the yarns share their
 * wave so that both press alike, and one that is slack presses nothing. The last term is the capstan: what
 * turns a yarn over another presses it, too.
 *
 * times the scene's static_friction where the contact did not slide in the last tick, and for whole
 * crossings.
 *
 * Forces are lengths, by which a contact gives way under them, Q24 lu. The tension of a projected link is
 * read from its strain: in one sweep of projections the next link draws a link's end out of its place, by
 * T h^2 / m of it. That of an elastic yarn is its law's. */
#include "rt/woven/woven.h"
#include "rt/woven/woven_links.h"
#include "rt/woven/yarn_slip.h"

enum {
  WEIGHT_ONE = 32,   /* of w */
  WEIGHT_SIDE = 8,
  GIVE_HALF = 81920, /* Q16, 1 / 2 kappa: strain to length, by half of a crossing's mass at a link's ends */
  GRIP_OF_FRICTION = 81920, /* Q16: crossing_friction is 4 F h^2 / m, a contact gives way by 5/4 of it */
  TURNS_MAX = 1 << 22,
  PRESSED_FILTER = 4,
  FADE = 16, /* ticks */
  LIMIT_MIN = YARN_PLACE_ONE >> 12, /* a thousandth of a yarn's strength: without friction yarns rattle */
  LIMIT_MAX = 1 << 30
};

typedef struct {
  link_view links;
  int32_t elastic[2];     /* by fray_axis, Q16: strain to length, of elastic yarns; else 0 */
  int32_t inverse[2];     /* 2^40 / spacing */
  int32_t thickness[2];   /* Q20 spacings */
} grip_gains;

/* 20 R^2 mantissa 2^(steps_bits - scale - 28), Q16, over 4^bits of contacts: see yarn_stretch.c; an elastic
 * step changes velocities by d e phi(u) mantissa 2^-(scale + 24), of which phi(0) = 1/2. */
static int32_t elastic_of(const fray_world *w, uint32_t class) {
  if (!world_has_elastic_yarns(w)) return 0;
  const yarn_gain *k = &w->woven.yarn_gains[class];
  const int32_t bits = w->woven.elastic_params->steps_bits;
  const int32_t down = k->pull_scale + 10 - bits + 2 * (int32_t)yarn_slip_bits(w);
  return (int32_t)fx_clamp64(fx_asr64(fx_mul_wide(w->woven.link_classes[class].r2, k->pull) * 5,
                                      (unsigned)fx_clamp(down, 0, 63)), 0, 1 << 28);
}

static void find_gains(const fray_world *w, grip_gains *k) {
  k->links = woven_links(w);
  for (uint32_t axis = 0; axis < 2; ++axis) {
    const uint32_t class = CLASS_WEFT + axis;
    k->elastic[axis] = elastic_of(w, class);
    const uint32_t rest = (uint32_t)w->woven.link_classes[class].rest;
    k->inverse[axis] = (int32_t)fx_divide_wide((uint64_t)1 << 40, rest);
    k->thickness[axis] =
        (int32_t)fx_clamp64(fx_mul_wide(w->params->thickness, k->inverse[axis]) >> 20, 0, TURNS_MAX);
  }
}

/* Of the link from k to k + 1, not negative. */
static int32_t tension_of(const fray_world *w, const grip_gains *k, const yarn_line *line, uint32_t number,
                          uint32_t axis) {
  const uint32_t spring = w->woven.spring_of[line->link + number * line->link_stride];
  const link_class *c = &w->woven.link_classes[w->woven.spring_kind[spring] & SPRING_CLASS];
  const uint32_t i = w->woven.spring_i[spring];
  const uint32_t j = w->woven.spring_j[spring];
  const vec3 d = link_vec(&k->links, i, j);
  const int32_t n = (int32_t)link_squared(d, link_coarse_vec(d));
  const int32_t e = (n < 0 || n > c->n_max ? c->n_max : n) - c->r2;
  if (e <= 0) return 0;
  const int32_t twice = (int32_t)(fx_mul_wide(e, c->inverse) >> 16); /* of the strain, Q20 */
  const int32_t longer = (int32_t)(fx_mul_wide(c->rest, twice) >> 21);
  const int32_t halves = particle_half_masses(w, i) + particle_half_masses(w, j);
  const int32_t gives = world_has_elastic_yarns(w) ? k->elastic[axis] : halves * GIVE_HALF;
  return (int32_t)fx_clamp64(fx_mul_wide(longer, gives) >> 16, 0, YARN_PRESSED_MAX);
}

/* Where a contact stands, between the links on both sides of its nearest particle. */
static int32_t tension_at(const fray_world *w, const grip_gains *k, uint32_t n, uint32_t axis,
                          const yarn_spot *spot) {
  const yarn_line line = yarn_line_of(w, axis, w->woven.contact_steps[n].number[axis]);
  const int32_t s = yarn_place_past(w->woven.contacts[n].place[axis]);
  const uint32_t nearest = spot->nearest;
  int32_t back = 0;
  int32_t on = 0;
  if ((spot->goes & (uint32_t)YARN_GOES_BACK) != 0) back = tension_of(w, k, &line, nearest - 1u, axis);
  if ((spot->goes & (uint32_t)YARN_GOES_ON) != 0) on = tension_of(w, k, &line, nearest, axis);
  return back + fx_mul_round(on - back, YARN_PLACE_HALF + s, YARN_PLACE_BITS);
}

/* The next crossing in a direction that holds its yarns together; the crossing itself where there is none. */
static uint32_t next_held(const fray_world *w, uint32_t crossing, uint32_t direction) {
  uint32_t at = crossing;
  uint32_t link;
  while (yarn_grid_step(world_yarn_grid(w), at, direction, &at, &link))
    if (crossing_state_at(w, at) != FRAY_DISCONNECTED) return at;
  return crossing;
}

/* Its place, and the word that names it. */
static uint32_t place_of(const fray_world *w, uint32_t crossing, uint32_t axis, index_t *neighbour) {
  const uint32_t warps = (uint32_t)w->params->warps;
  if (crossing_state_at(w, crossing) == FRAY_WHOLE) {
    const uint32_t k = axis == (uint32_t)FRAY_WARP ? crossing / warps : crossing % warps;
    *neighbour = (index_t)(YARN_NEIGHBOUR_WHOLE | k);
    return yarn_place_of(k);
  }
  *neighbour = (index_t)crossing_contact(w, crossing);
  return w->woven.contacts[*neighbour].place[axis];
}

typedef struct {
  int32_t weight; /* w, of WEIGHT_ONE */
  int32_t turns;  /* sum of T / d, Q20 */
} grip_sides;

/* place: of the crossing, on its yarn of that direction. */
static index_t add_side(const fray_world *w, const grip_gains *k, uint32_t c, uint32_t direction,
                        uint32_t place, grip_sides *sides) {
  const uint32_t axis = direction / 2u;
  const uint32_t next = next_held(w, c, direction);
  index_t neighbour = YARN_NEIGHBOUR_NONE;
  if (next == c) {
    sides->weight += WEIGHT_SIDE;
    return neighbour;
  }
  const uint32_t there = place_of(w, next, axis, &neighbour);
  if (crossing_warp_over(w, next) == crossing_warp_over(w, c)) return neighbour;
  const uint32_t apart = yarn_places_apart(place, there);
  const uint32_t distance = apart < (uint32_t)YARN_SLIP_NEAR ? (uint32_t)YARN_SLIP_NEAR : apart;
  const uint64_t thickness = (uint32_t)k->thickness[axis];
  sides->weight += WEIGHT_SIDE;
  sides->turns += (int32_t)(fx_divide_wide(thickness << YARN_PLACE_BITS, distance >> 1) / 2u);
  return neighbour;
}

/* N. */
static int32_t pressing(int32_t warp, int32_t weft, int32_t turns) {
  const uint32_t sum = (uint32_t)(warp + weft);
  const uint32_t both = sum != 0 ? fx_divide_wide((uint64_t)fx_mul_wide(warp, weft), sum) : 0;
  return fx_clamp_wide((int64_t)both * fx_min(turns, TURNS_MAX) >> YARN_PLACE_BITS, YARN_PRESSED_MAX);
}

static void press(fray_world *w, const grip_gains *k, uint32_t n, const yarn_touch *touch, int32_t turns) {
  const int32_t warp = tension_at(w, k, n, FRAY_WARP, &touch->spot[FRAY_WARP]);
  const int32_t weft = tension_at(w, k, n, FRAY_WEFT, &touch->spot[FRAY_WEFT]);
  yarn_contact *c = &w->woven.contacts[n];
  const int32_t pressed = yarn_contact_pressed(c);
  c->grip = (uint32_t)(pressed + (pressing(warp, weft, turns) - pressed) / PRESSED_FILTER) << 2;
}

/* Q24 lu: a length for kappa, of elastic yarns for a fourth of it. */
static int64_t held_by(const fray_world *w, int32_t weight, int64_t pressed, int slides) {
  const yarn_params *yarns = w->woven.yarn_constants;
  const unsigned down = (world_has_elastic_yarns(w) ? 14u : 16u) + 2u * yarn_slip_bits(w);
  const int64_t grip = fx_mul_wide(yarns->crossing_friction, GRIP_OF_FRICTION) >> down;
  const int64_t rubbed = pressed * yarns->slip_friction >> 16;
  const int64_t sliding = fx_clamp64(grip * fx_max(weight, 1) / WEIGHT_ONE + rubbed, 0, 1 << 30);
  return slides ? sliding : sliding * yarns->static_friction >> 16;
}

/* |v| across a direction. */
static int32_t length_across(vec3 v, vec3 unit) {
  const vec3 across = vec_sub(v, vec_scale_unit(unit, vec_dot_unit(v, unit)));
  return vec_squared(across) == 0 ? 0 : (int32_t)vec_length(across);
}

static int32_t limit_of(const fray_world *w, const grip_gains *k, uint32_t n, uint32_t axis,
                        const yarn_touch *touch, int32_t weight, int slides) {
  const vec3 along = vec_unit(touch->spot[axis].along, vec_make(0, 0, 0));
  const int32_t pressed = yarn_contact_pressed(&w->woven.contacts[n]);
  const int64_t held = held_by(w, weight, (int64_t)pressed + length_across(touch->gap, along), slides);
  return (int32_t)fx_clamp64(held * k->inverse[axis] >> 20, LIMIT_MIN, LIMIT_MAX);
}

static int32_t faded(int32_t offset) {
  return offset - (offset < 0 ? offset - (FADE - 1) : offset + (FADE - 1)) / FADE;
}

/* Of elastic yarns only where the gap grows no larger, which would store energy. */
static void fade(const fray_world *w, yarn_contact *c, yarn_touch *touch) {
  const vec3 offset = vec_of(c->offset);
  vec_store(c->offset, vec_make(faded(offset.x), faded(offset.y), faded(offset.z)));
  const vec3 gap = yarn_touch_gap(touch, c);
  if (world_has_elastic_yarns(w) && vec_squared(gap) > vec_squared(touch->gap))
    vec_store(c->offset, offset);
  else
    touch->gap = gap;
}

static void update_contact(fray_world *w, const grip_gains *k, uint32_t n) {
  yarn_contact *c = &w->woven.contacts[n];
  yarn_contact_step *t = &w->woven.contact_steps[n];
  const uint32_t crossing = yarn_contact_crossing(w, n);
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t slid = c->grip & 3u;
  grip_sides sides = {0, 0};
  yarn_touch touch;
  t->number[FRAY_WEFT] = (index_t)(crossing / warps);
  t->number[FRAY_WARP] = (index_t)(crossing % warps);
  for (uint32_t direction = 0; direction < 4; ++direction)
    t->neighbour[direction] = add_side(w, k, crossing, direction, c->place[direction / 2u], &sides);
  if (!yarn_touch_at(w, n, &touch)) return;
  fade(w, c, &touch);
  press(w, k, n, &touch, sides.turns);
  for (uint32_t axis = 0; axis < 2; ++axis)
    t->limit[axis] = limit_of(w, k, n, axis, &touch, sides.weight, (slid >> axis & 1u) != 0);
}

void yarn_grip_update(fray_world *w) {
  FRAY_ASSERT(world_has_yarns(w));
  grip_gains k;
  find_gains(w, &k);
  for (uint32_t n = 0; n < (uint32_t)w->woven.yarn_counts->split; ++n)
    if (yarn_contact_acts(w, n)) update_contact(w, &k, n);
}

/* One yarn at a whole crossing: its direction, Q30; its tension; and the sum of its links' forces. */
typedef struct {
  vec3 unit, force;
  int32_t tension;
} yarn_load;

static yarn_load load_at(const fray_world *w, const grip_gains *k, uint32_t crossing, uint32_t axis) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t number = axis == (uint32_t)FRAY_WARP ? crossing % warps : crossing / warps;
  const uint32_t at = axis == (uint32_t)FRAY_WARP ? crossing / warps : crossing % warps;
  const yarn_line line = yarn_line_of(w, axis, number);
  const vec3 none = vec_make(0, 0, 0);
  yarn_load load = {none, none, 0};
  yarn_spot spot;
  if (!yarn_spot_find(w, &line, yarn_place_of(at), &spot)) return load;
  vec3 along = none;
  for (uint32_t side = 0; side < 2; ++side) {
    const uint32_t goes = side == 0 ? (uint32_t)YARN_GOES_BACK : (uint32_t)YARN_GOES_ON;
    if ((spot.goes & goes) == 0) continue;
    const int32_t tension = tension_of(w, k, &line, side == 0 ? at - 1u : at, axis);
    const vec3 from = world_position(w, spot.particle[side]);
    const vec3 on = vec_sub(world_position(w, spot.particle[side + 1u]), from);
    const vec3 unit = vec_unit(on, none);
    along = vec_add(along, vec_clamp(on, FX_LU));
    load.tension += tension / 2;
    load.force = vec_add(load.force, vec_scale_unit(unit, side == 0 ? -tension : tension));
  }
  load.unit = vec_unit(along, none);
  return load;
}

int yarn_grip_holds(const fray_world *w, uint32_t crossing) {
  FRAY_ASSERT(crossing_state_at(w, crossing) == FRAY_WHOLE);
  grip_gains k;
  find_gains(w, &k);
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t place[2] = {yarn_place_of(crossing % warps), yarn_place_of(crossing / warps)};
  const yarn_load load[2] = {load_at(w, &k, crossing, FRAY_WEFT), load_at(w, &k, crossing, FRAY_WARP)};
  grip_sides sides = {0, 0};
  for (uint32_t direction = 0; direction < 4; ++direction)
    (void)add_side(w, &k, crossing, direction, place[direction / 2u], &sides);
  const int32_t pressed = pressing(load[FRAY_WARP].tension, load[FRAY_WEFT].tension, sides.turns);
  const vec3 carried = vec_round(vec_sub(load[FRAY_WEFT].force, load[FRAY_WARP].force), 1);
  for (uint32_t axis = 0; axis < 2; ++axis) {
    const int64_t across = length_across(carried, load[axis].unit);
    const uint32_t along = fx_magnitude(vec_dot_unit(carried, load[axis].unit));
    if ((int64_t)along > held_by(w, sides.weight, pressed + across, 0)) return 0;
  }
  return 1;
}
