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
#ifndef FRAY_TESTS_YARN_CHECK_H
#define FRAY_TESTS_YARN_CHECK_H

#include "rt/model/couples.h"
#include "tests/lib/world_fixture.h"

typedef struct {
  uint8_t *couple, *kind; /* of the tick before */
  uint32_t *warp_at;
  uint32_t bad;
} yarn_check;

FIXTURE void yarn_check_keep(yarn_check *k, const fray_world *w) {
  const uint32_t crossings = w->capacity[POOL_CROSSINGS];
  memcpy(k->couple, w->couple, crossings);
  memcpy(k->kind, w->row_class, w->capacity[POOL_ROWS]);
  for (uint32_t c = 0; c < crossings; ++c) k->warp_at[c] = w->warp_at[c];
}

FIXTURE void yarn_check_open(yarn_check *k, const fixture *f) {
  k->couple = malloc(f->w->capacity[POOL_CROSSINGS]);
  k->kind = malloc(f->w->capacity[POOL_ROWS]);
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

FIXTURE void yarn_check_bad(yarn_check *k, const char *what, uint32_t at) {
  if (k->bad++ < 10) printf("yarn_check: %s %u\n", what, at);
}

FIXTURE int yarn_check_allowed(uint32_t from, uint32_t to) {
  from &= COUPLE_STATE;
  to &= COUPLE_STATE;
  if (from == to) return 1;
  if (to == FRAY_LOOSE) return from == FRAY_WHOLE || from == FRAY_CONNECTED;
  return to == FRAY_DISCONNECTED && from == FRAY_LOOSE;
}

/* Every crossing has its weft's particle, and of couples its warp's, which nobody else has. */
FIXTURE void yarn_check_couples(yarn_check *k, const fray_world *w) {
  const uint32_t crossings = w->capacity[POOL_CROSSINGS];
  uint8_t *used = calloc(w->capacity[POOL_PARTICLES], 1);
  uint32_t counts[4] = {0, 0, 0, 0};
  if (used == NULL) fixture_give_up("yarn_check", "out of memory");
  for (uint32_t c = 0; c < crossings; ++c) {
    const uint32_t now = w->couple[c] & COUPLE_STATE;
    const uint32_t weft = w->crossing[c];
    const uint32_t warp = w->warp_at[c];
    ++counts[now];
    if (!yarn_check_allowed(k->couple[c], now)) yarn_check_bad(k, "transition of crossing", c);
    if (now != FRAY_WHOLE && couple_is_held(w, c)) yarn_check_bad(k, "held crossing split", c);
    if ((now == FRAY_WHOLE) != (weft == warp)) yarn_check_bad(k, "particles of crossing", c);
    if ((k->couple[c] & COUPLE_STATE) != FRAY_WHOLE &&
        k->warp_at[c] != warp)
      yarn_check_bad(k, "warp particle changed at crossing", c);
    used[weft] = (uint8_t)(used[weft] + 1);
    if (warp != weft) used[warp] = (uint8_t)(used[warp] + 1);
    if (w->place[weft] != c || w->place[warp] != c) yarn_check_bad(k, "place of crossing", c);
  }
  for (uint32_t p = 0; p < w->capacity[POOL_PARTICLES]; ++p)
    if (used[p] != (p < w->particles)) yarn_check_bad(k, "owners of particle", p);
  /* mass, in half crossings */
  const uint32_t couples = counts[1] + counts[2] + counts[3];
  if (2 * counts[0] + 2 * couples != 2 * crossings || couples != w->particles - crossings)
    yarn_check_bad(k, "mass: couples", couples);
  if ((int32_t)counts[1] != w->yarn_state->connected || (int32_t)counts[2] != w->yarn_state->loose ||
      (int32_t)counts[3] != w->yarn_state->disconnected || (int32_t)couples != w->yarn_state->split)
    yarn_check_bad(k, "counts: couples", couples);
  free(used);
}

FIXTURE int yarn_check_end_may_tear(const fray_world *w, uint32_t crossing) {
  return couple_is_held(w, crossing) || couple_at(w, crossing) != FRAY_WHOLE;
}

FIXTURE int yarn_check_disconnected(const fray_world *w, uint32_t a, uint32_t b) {
  return couple_at(w, a) == FRAY_DISCONNECTED || couple_at(w, b) == FRAY_DISCONNECTED;
}

/* Rows are where they were born, between the particles of their yarns; nothing dead comes back but the
 * second spring of a diagonal, once. */
FIXTURE void yarn_check_rows(yarn_check *k, const fray_world *w) {
  const uint32_t last_base = weave_rows(world_weave(w));
  const uint32_t shears_from = (uint32_t)(w->params->links + w->params->bends);
  for (uint32_t row = 0; row < w->capacity[POOL_ROWS]; ++row) {
    const uint32_t home = w->home[row];
    const int alive = w->row_class[row] != ROW_DEAD;
    uint32_t a, b, from, to;
    couple_ends(w, row, &a, &b);
    weave_ends(world_weave(w), home, &from, &to);
    if (!((w->row_i[row] == a && w->row_j[row] == b) || (w->row_i[row] == b && w->row_j[row] == a)))
      yarn_check_bad(k, "ends of row", row);
    if (alive && w->row_class[row] != couple_kind(w, row)) yarn_check_bad(k, "kind of row", row);
    if (alive && k->kind[row] == ROW_DEAD && home < last_base) yarn_check_bad(k, "undead row", row);
    if (!alive && home < (uint32_t)w->params->links &&
        (!yarn_check_end_may_tear(w, from) || !yarn_check_end_may_tear(w, to)))
      yarn_check_bad(k, "cut before its ends split: row", row);
    if (home < shears_from) continue;
    if (alive && yarn_check_disconnected(w, from, to)) yarn_check_bad(k, "diagonal kept: row", row);
    if (home >= last_base) continue;
    const int split = couple_at(w, from) != FRAY_WHOLE || couple_at(w, to) != FRAY_WHOLE;
    const int twin = w->row_class[w->row_of[home + (uint32_t)w->params->shears]] != ROW_DEAD;
    if (twin != (alive && split)) yarn_check_bad(k, "second spring of row", row);
  }
}

FIXTURE void yarn_check_tick(yarn_check *k, const fixture *f) {
  const fray_world *w = f->w;
  yarn_check_couples(k, w);
  yarn_check_rows(k, w);
  const uint64_t topology =
      (uint64_t)(uint32_t)w->state->topology[1] << 32 | (uint32_t)w->state->topology[0];
  if (world_topology(w) != topology) yarn_check_bad(k, "topology at tick", (uint32_t)w->state->tick);
  yarn_check_keep(k, w);
}

#endif
