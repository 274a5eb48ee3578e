/* SPDX-License-Identifier: Apache-2.0 */
/* Walks a world with yarns after every tick: no particle, spring or couple is lost, every transition
 * is one of the paper's, no spring is cut before its ends have split, and the hash kept by the way is
 * the one of the whole. Says what is wrong, once a tick, and counts it.
 *
 *   yarn_check k;
 *   yarn_check_open(&k, &f);
 *   ... fixture_tick(); yarn_check_tick(&k, &f); ...
 *   CHECK_EQ_INT(k.bad, 0);
 *   yarn_check_close(&k);
 */
#ifndef FRAY_TESTS_LIB_YARN_CHECK_H
#define FRAY_TESTS_LIB_YARN_CHECK_H

#include "rt/state/crossing.h"
#include "tests/lib/world_fixture.h"

typedef struct {
  uint8_t *couple, *kind; /* of the tick before */
  uint32_t *warp_at;
  uint32_t bad;
} yarn_check;

FIXTURE void yarn_check_keep(yarn_check *k, const fray_world *w) {
  const uint32_t crossings = w->capacity[POOL_CROSSINGS];
  memcpy(k->couple, w->woven.crossing_state, crossings);
  memcpy(k->kind, w->woven.spring_kind, w->capacity[POOL_SPRINGS]);
  for (uint32_t c = 0; c < crossings; ++c) k->warp_at[c] = w->woven.warp_particle[c];
}

FIXTURE void yarn_check_open(yarn_check *k, const fixture *f) {
  k->couple = malloc(f->w->capacity[POOL_CROSSINGS]);
  k->kind = malloc(f->w->capacity[POOL_SPRINGS]);
  k->warp_at = malloc(f->w->capacity[POOL_CROSSINGS] * sizeof *k->warp_at);
  k->bad = 0;
  if (k->couple == NULL || k->kind == NULL || k->warp_at == NULL)
    fixture_give_up("yarn_check", "out of memory");
  yarn_check_keep(k, f->w);
}

FIXTURE void yarn_check_close(yarn_check *k) {
  free(k->couple);
  free(k->kind);
  free(k->warp_at);
}

/* In half crossings, of particles from `first` on. */
FIXTURE void yarn_momentum(const fray_world *w, uint32_t first, int64_t sum[3]) {
  const int32_t *const speed[3] = {w->p.vx, w->p.vy, w->p.vz};
  for (uint32_t axis = 0; axis < 3; ++axis) {
    sum[axis] = 0;
    for (uint32_t p = first; p < w->p.count; ++p)
      sum[axis] += (world_has_yarns(w) && particle_is_half(w, p) ? 1 : 2) * (int64_t)speed[axis][p];
  }
}

FIXTURE void yarn_check_bad(yarn_check *k, const char *what, uint32_t at) {
  if (k->bad++ < 10) printf("yarn_check: %s %u\n", what, at);
}

FIXTURE int yarn_check_allowed(uint32_t from, uint32_t to) {
  from &= CROSSING_STATE;
  to &= CROSSING_STATE;
  if (from == to) return 1;
  if (to == FRAY_LOOSE) return from == FRAY_WHOLE || from == FRAY_CONNECTED;
  return to == FRAY_DISCONNECTED && from == FRAY_LOOSE;
}

/* Every crossing has its weft's particle, and of couples its warp's, which nobody else has. */
FIXTURE void yarn_check_crossings(yarn_check *k, const fray_world *w) {
  const uint32_t crossings = w->capacity[POOL_CROSSINGS];
  uint8_t *used = calloc(w->capacity[POOL_PARTICLES], 1);
  uint32_t counts[4] = {0, 0, 0, 0};
  if (used == NULL) fixture_give_up("yarn_check", "out of memory");
  for (uint32_t c = 0; c < crossings; ++c) {
    const uint32_t now = w->woven.crossing_state[c] & CROSSING_STATE;
    const uint32_t weft = w->woven.crossing_particle[c];
    const uint32_t warp = w->woven.warp_particle[c];
    ++counts[now];
    if (!yarn_check_allowed(k->couple[c], now)) yarn_check_bad(k, "transition of crossing", c);
    if (now != FRAY_WHOLE && crossing_is_attached(w, c)) yarn_check_bad(k, "held crossing split", c);
    if ((now == FRAY_WHOLE) != (weft == warp)) yarn_check_bad(k, "particles of crossing", c);
    if ((k->couple[c] & CROSSING_STATE) != FRAY_WHOLE &&
        k->warp_at[c] != warp)
      yarn_check_bad(k, "warp particle changed at crossing", c);
    used[weft] = (uint8_t)(used[weft] + 1);
    if (warp != weft) used[warp] = (uint8_t)(used[warp] + 1);
    if (w->woven.crossing_of[weft] != c || w->woven.crossing_of[warp] != c) yarn_check_bad(k, "place of crossing", c);
  }
  for (uint32_t p = 0; p < w->capacity[POOL_PARTICLES]; ++p)
    if (used[p] != (p < w->p.count)) yarn_check_bad(k, "owners of particle", p);
  /* mass, in half crossings */
  const uint32_t couples = counts[1] + counts[2] + counts[3];
  if (2 * counts[0] + 2 * couples != 2 * crossings || couples != w->p.count - crossings)
    yarn_check_bad(k, "mass: couples", couples);
  if ((int32_t)counts[1] != w->woven.yarn_counts->connected || (int32_t)counts[2] != w->woven.yarn_counts->loose ||
      (int32_t)counts[3] != w->woven.yarn_counts->disconnected || (int32_t)couples != w->woven.yarn_counts->split)
    yarn_check_bad(k, "counts: couples", couples);
  free(used);
}

FIXTURE int yarn_check_end_may_tear(const fray_world *w, uint32_t crossing) {
  return crossing_is_attached(w, crossing) || crossing_state_at(w, crossing) != FRAY_WHOLE;
}

FIXTURE int yarn_check_disconnected(const fray_world *w, uint32_t a, uint32_t b) {
  return crossing_state_at(w, a) == FRAY_DISCONNECTED || crossing_state_at(w, b) == FRAY_DISCONNECTED;
}

/* Rows are where they were born, between the particles of their yarns; nothing dead comes back but the
 * second spring of a diagonal, once. */
FIXTURE void yarn_check_springs(yarn_check *k, const fray_world *w) {
  const uint32_t last_base = yarn_grid_springs(world_yarn_grid(w));
  const uint32_t shears_from = (uint32_t)(w->params->links + w->params->bends);
  for (uint32_t row = 0; row < w->capacity[POOL_SPRINGS]; ++row) {
    const uint32_t home = w->woven.canonical_id[row];
    const int alive = w->woven.spring_kind[row] != SPRING_DEAD;
    uint32_t a, b, from, to;
    crossing_spring_ends(w, row, &a, &b);
    yarn_grid_ends(world_yarn_grid(w), home, &from, &to);
    if (!((w->woven.spring_i[row] == a && w->woven.spring_j[row] == b) || (w->woven.spring_i[row] == b && w->woven.spring_j[row] == a)))
      yarn_check_bad(k, "ends of row", row);
    if (alive && w->woven.spring_kind[row] != crossing_spring_kind(w, row)) yarn_check_bad(k, "kind of row", row);
    if (alive && k->kind[row] == SPRING_DEAD && home < last_base) yarn_check_bad(k, "undead row", row);
    if (!alive && home < (uint32_t)w->params->links &&
        (!yarn_check_end_may_tear(w, from) || !yarn_check_end_may_tear(w, to)))
      yarn_check_bad(k, "cut before its ends split: row", row);
    if (home < shears_from) continue;
    if (alive && yarn_check_disconnected(w, from, to)) yarn_check_bad(k, "diagonal kept: row", row);
    if (home >= last_base) continue;
    const int split = crossing_state_at(w, from) != FRAY_WHOLE || crossing_state_at(w, to) != FRAY_WHOLE;
    const int twin = w->woven.spring_kind[w->woven.spring_of[home + (uint32_t)w->params->shears]] != SPRING_DEAD;
    if (twin != (alive && split)) yarn_check_bad(k, "second spring of row", row);
  }
}

FIXTURE void yarn_check_tick(yarn_check *k, const fixture *f) {
  const fray_world *w = f->w;
  yarn_check_crossings(k, w);
  yarn_check_springs(k, w);
  if (!fixture_topology_holds(w)) yarn_check_bad(k, "topology at tick", (uint32_t)w->state->tick[0]);
  yarn_check_keep(k, w);
}

#endif
