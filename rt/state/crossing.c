/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/state/crossing.h"

static int32_t *count_of(fray_world *w, fray_crossing_state of) {
  yarn_state *s = w->woven.yarn_counts;
  return of == FRAY_CONNECTED ? &s->connected : of == FRAY_LOOSE ? &s->loose : &s->disconnected;
}

/* Every change of a crossing's byte goes through here, so that the topology's hash follows. */
static void write_state(fray_world *w, uint32_t c, uint32_t value) {
  const uint32_t old = w->woven.crossing_state[c];
  if (old != FRAY_WHOLE) world_toggle(w, TOPOLOGY_CROSSING, c, old);
  if (value != FRAY_WHOLE) world_toggle(w, TOPOLOGY_CROSSING, c, value);
  w->woven.crossing_state[c] = (uint8_t)value;
}

void crossing_set_pending(fray_world *w, uint32_t c, int pending) {
  FRAY_ASSERT(c < w->capacity[POOL_CROSSINGS] && (pending == 0 || pending == 1));
  const int was_pending = (w->woven.crossing_state[c] & CROSSING_PENDING) != 0;
  if (was_pending == pending) return;
  write_state(w, c, w->woven.crossing_state[c] ^ (uint32_t)CROSSING_PENDING);
  w->woven.yarn_counts->pending += pending ? 1 : -1;
  FRAY_ASSERT(w->woven.yarn_counts->pending >= 0);
}

static uint32_t canonical_first_shear(const fray_world *w) {
  return (uint32_t)(w->params->links + w->params->bends);
}

uint8_t crossing_spring_kind(const fray_world *w, uint32_t spring) {
  FRAY_ASSERT(world_has_yarns(w) && spring < w->capacity[POOL_SPRINGS]);
  const uint32_t canonical = w->woven.canonical_id[spring];
  const uint32_t i = w->woven.spring_i[spring];
  const uint32_t j = w->woven.spring_j[spring];
  const uint32_t ends = (particle_is_half(w, i) ? (uint32_t)SPRING_HALF_I : 0u) |
                        (particle_is_half(w, j) ? (uint32_t)SPRING_HALF_J : 0u);
  const uint32_t half_mass = ends != 0 ? SPRING_HALF_MASS | ends : 0u;
  if (canonical >= canonical_first_shear(w)) {
    const uint32_t is_half = canonical >= yarn_grid_springs(world_yarn_grid(w)) || ends != 0;
    return (uint8_t)(is_half ? CLASS_SHEAR_HALF | half_mass : CLASS_SHEAR);
  }
  uint32_t a;
  uint32_t b;
  yarn_grid_ends(world_yarn_grid(w), canonical, &a, &b);
  const uint32_t axis = a / (uint32_t)w->params->warps == b / (uint32_t)w->params->warps
                            ? (uint32_t)CLASS_WEFT
                            : (uint32_t)CLASS_WARP;
  /* where warps are as close as wefts, both have one class */
  const int square = w->woven.link_classes[CLASS_WEFT].rest == w->woven.link_classes[CLASS_WARP].rest;
  const uint32_t base = square ? (uint32_t)CLASS_WEFT : axis;
  if (canonical >= (uint32_t)w->params->links) return (uint8_t)(base | half_mass);
  /* a projection between two ends of half mass is one between two of whole mass */
  return (uint8_t)(base | (ends != (SPRING_HALF_I | SPRING_HALF_J) ? half_mass : 0u));
}

/* The particle of a crossing at which a canonical spring ends. */
static uint32_t end_of(const fray_world *w, uint32_t canonical, uint32_t c, int along_warp) {
  if (canonical < canonical_first_shear(w))
    return along_warp ? w->woven.warp_particle[c] : w->woven.crossing_particle[c];
  /* of a diagonal's two springs the first is between the upper yarns, the second between the lower ones */
  const int upper = canonical < yarn_grid_springs(world_yarn_grid(w));
  return upper == crossing_warp_over(w, c) ? w->woven.warp_particle[c] : w->woven.crossing_particle[c];
}

void crossing_spring_ends(const fray_world *w, uint32_t spring, uint32_t *a, uint32_t *b) {
  FRAY_ASSERT(spring < w->capacity[POOL_SPRINGS]);
  const uint32_t canonical = w->woven.canonical_id[spring];
  uint32_t from;
  uint32_t to;
  yarn_grid_ends(world_yarn_grid(w), canonical, &from, &to);
  const int along_warp = from / (uint32_t)w->params->warps != to / (uint32_t)w->params->warps;
  *a = end_of(w, canonical, from, along_warp);
  *b = end_of(w, canonical, to, along_warp);
}

static void replace_end(fray_world *w, uint32_t spring, uint32_t from, uint32_t to) {
  FRAY_ASSERT(w->woven.spring_i[spring] == from || w->woven.spring_j[spring] == from);
  if (w->woven.spring_i[spring] == from)
    w->woven.spring_i[spring] = (index_t)to;
  else
    w->woven.spring_j[spring] = (index_t)to;
}

static void update_kind(fray_world *w, uint32_t spring) {
  if (w->woven.spring_kind[spring] != SPRING_DEAD)
    w->woven.spring_kind[spring] = crossing_spring_kind(w, spring);
}

/* A diagonal gets its second spring when its first end splits (figure 5c): the first one stays between the
 * upper yarns, the second between the lower ones. */
static void split_diagonal(fray_world *w, uint32_t canonical, uint32_t c) {
  const uint32_t upper = w->woven.spring_of[canonical];
  const uint32_t lower = w->woven.spring_of[canonical + (uint32_t)w->params->shears];
  const int is_first_split = w->woven.spring_kind[upper] == CLASS_SHEAR;
  replace_end(w, crossing_warp_over(w, c) ? upper : lower, w->woven.crossing_particle[c],
              w->woven.warp_particle[c]);
  update_kind(w, upper);
  if (is_first_split) {
    world_toggle(w, TOPOLOGY_SPRING, w->woven.canonical_id[lower], SPRING_DEAD);
    w->woven.spring_kind[lower] = crossing_spring_kind(w, lower);
  } else {
    update_kind(w, lower);
  }
}

static void split_springs(fray_world *w, uint32_t c) {
  yarn_grid_star star;
  yarn_grid_springs_at(world_yarn_grid(w), c, &star);
  for (uint32_t n = 0; n < star.warp_end; ++n) {
    const uint32_t spring = w->woven.spring_of[star.spring[n]];
    if (n >= star.weft_end) replace_end(w, spring, w->woven.crossing_particle[c], w->woven.warp_particle[c]);
    update_kind(w, spring);
  }
  for (uint32_t n = star.warp_end; n < star.count; ++n) split_diagonal(w, star.spring[n], c);
}

static void copy_axis(int32_t *x, int32_t *q, int32_t *v, int8_t *r, uint32_t weft, uint32_t warp) {
  x[warp] = x[weft];
  q[warp] = q[weft];
  v[warp] = v[weft];
  r[warp] = r[weft];
}

static void begin_contact(fray_world *w, uint32_t c, uint32_t n) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const yarn_contact at_crossing = {{yarn_place_of(c % warps), yarn_place_of(c / warps)}, {0, 0, 0}, 0};
  w->woven.contacts[n] = at_crossing;
}

int crossing_split(fray_world *w, uint32_t c, fray_crossing_state to) {
  FRAY_ASSERT(world_has_yarns(w) && c < w->capacity[POOL_CROSSINGS] && to != FRAY_WHOLE);
  FRAY_ASSERT(crossing_state_at(w, c) == FRAY_WHOLE && !crossing_is_attached(w, c));
  if (w->p.count == w->capacity[POOL_PARTICLES]) return 0;
  const uint32_t weft = w->woven.crossing_particle[c];
  const uint32_t warp = w->p.count;
  ++w->p.count;
  ++w->woven.yarn_counts->split;
  ++*count_of(w, to);
  copy_axis(w->p.x, w->p.qx, w->p.vx, w->p.rx, weft, warp);
  copy_axis(w->p.y, w->p.qy, w->p.vy, w->p.ry, weft, warp);
  copy_axis(w->p.z, w->p.qz, w->p.vz, w->p.rz, weft, warp);
  w->woven.warp_particle[c] = (index_t)warp;
  w->woven.crossing_of[warp] = (index_t)c;
  begin_contact(w, c, warp - (uint32_t)w->params->particles);
  world_toggle(w, TOPOLOGY_WARP, c, warp);
  write_state(w, c, (w->woven.crossing_state[c] & (uint32_t)CROSSING_PENDING) | to);
  split_springs(w, c);
  return 1;
}

void crossing_release_diagonals(fray_world *w, uint32_t c) {
  yarn_grid_star star;
  yarn_grid_springs_at(world_yarn_grid(w), c, &star);
  for (uint32_t n = star.warp_end; n < star.count; ++n) {
    world_kill_spring(w, w->woven.spring_of[star.spring[n]]);
    world_kill_spring(w, w->woven.spring_of[star.spring[n] + (uint32_t)w->params->shears]);
  }
}

void crossing_set_left(fray_world *w, uint32_t c) {
  if (crossing_state_at(w, c) == FRAY_CONNECTED) {
    crossing_set_pending(w, c, 0);
    crossing_set_state(w, c, FRAY_LOOSE);
  }
  FRAY_ASSERT(crossing_state_at(w, c) == FRAY_LOOSE);
  write_state(w, c, w->woven.crossing_state[c] | (uint32_t)CROSSING_LEFT);
}

void crossing_set_state(fray_world *w, uint32_t c, fray_crossing_state to) {
  FRAY_ASSERT(c < w->capacity[POOL_CROSSINGS] && to != FRAY_WHOLE);
  FRAY_ASSERT(crossing_state_at(w, c) != FRAY_WHOLE && *count_of(w, crossing_state_at(w, c)) > 0);
  --*count_of(w, crossing_state_at(w, c));
  ++*count_of(w, to);
  write_state(w, c, (w->woven.crossing_state[c] & (uint32_t)CROSSING_PENDING) | to);
  if (to != FRAY_DISCONNECTED) return;
  const yarn_contact none = {{0, 0}, {0, 0, 0}, 0};
  w->woven.contacts[crossing_contact(w, c)] = none;
  crossing_release_diagonals(w, c);
}
