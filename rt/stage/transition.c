/* SPDX-License-Identifier: Apache-2.0 */
/* From the base cloth to yarns (Metaaphanon 2009, section 3.4). A spring over its transition strain
 * wants both its ends and their immediate neighbours split. A couple whose yarns are farther apart
 * than loose_max comes apart, and from it splitting spreads along both yarns, up to and including the
 * first crossing of the opposite weave. The spread ends where a yarn is cut or held.
 *
 * Here crossings are marked; split.c takes them, so many a tick, in order. No more than that come apart
 * in a tick either, in the order in which they split; the others are found again in the next one. */
#include "rt/model/couples.h"
#include "rt/stage/slip.h"
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

static void want(fray_world *w, uint32_t crossing) {
  const uint32_t now = w->couple[crossing]; /* with its mark, if it has one */
  if ((now != FRAY_WHOLE && now != FRAY_CONNECTED) || couple_is_held(w, crossing)) return;
  if (now == FRAY_WHOLE && w->particles == w->capacity[POOL_PARTICLES]) {
    w->state->faults |= (int32_t)FRAY_FAULT_SPARES_FULL;
    return;
  }
  couple_want(w, crossing, 1);
}

static void want_around(fray_world *w, uint32_t crossing) {
  const weave_cross around = weave_cross_at(world_weave(w), crossing);
  want(w, crossing);
  for (uint32_t way = 0; way < 4; ++way) want(w, around.next[way]);
}

static int is_cut(const fray_world *w, uint32_t link) {
  return w->row_class[w->row_of[link]] == ROW_DEAD;
}

__attribute__((noinline)) static void part_couple(fray_world *w, uint32_t from) {
  couple_change(w, from, FRAY_DISCONNECTED);
  const int over = couple_warp_over(w, from);
  for (uint32_t way = 0; way < 4; ++way) {
    uint32_t at = from;
    uint32_t next;
    uint32_t link;
    while (weave_step(world_weave(w), at, way, &next, &link) && !is_cut(w, link) &&
           !couple_is_held(w, next)) {
      want(w, next);
      if (couple_warp_over(w, next) != over) break;
      at = next;
    }
  }
}

__attribute__((noinline)) static void find_strained(fray_world *w) {
  const int32_t least = w->yarns->transition_min;
  const link_view view = {w->x, w->y, w->z, w->row_i, w->row_j, w->row_class, w->links,
                          w->capacity[POOL_LINK_CLASSES]};
  const uint32_t end = (uint32_t)w->params->links;
  for (uint32_t row = 0; row < end; ++row) {
    row = wide_over(w->kernel, view, least, row, end);
    if (row == end) break;
    const uint32_t kind = w->row_class[row];
    if (kind == ROW_DEAD) continue;
    const int32_t rest = w->links[kind & ROW_CLASS].rest;
    const vec3 d = vec_sub(world_position(w, w->row_j[row]), world_position(w, w->row_i[row]));
    const uint64_t n = vec_squared(d);
    if (n <= link_stretched_squared(rest, least)) continue; /* no draw is below it */
    if (n <= link_stretched_squared(rest, world_transition(w, row))) continue;
    want_around(w, w->place[w->row_i[row]]);
    want_around(w, w->place[w->row_j[row]]);
  }
}

static int is_apart(const fray_world *w, uint32_t c, uint64_t bound) {
  slip_pair pair;
  if (w->yarns->loose_by_particles != 0)
    return vec_squared(vec_sub(world_position(w, w->warp_at[c]),
                               world_position(w, w->crossing[c]))) > bound;
  return !slip_closest(w, c, &pair) || vec_squared(slip_gap(w, &pair)) > bound;
}

__attribute__((noinline)) static void find_apart(fray_world *w) {
  const uint64_t bound = fx_square(w->yarns->loose_max);
  uint32_t left = w->capacity[POOL_SPLITS];
  for (uint32_t p = (uint32_t)w->params->particles; p < w->particles; ++p) {
    const uint32_t c = w->place[p];
    if (couple_at(w, c) != FRAY_LOOSE) continue;
    if (!is_apart(w, c, bound)) continue;
    if (left == 0) {
      w->state->faults |= (int32_t)FRAY_FAULT_SPLITS_WAIT;
      return;
    }
    --left;
    part_couple(w, c);
  }
}

void transition_run(fray_world *w) {
  if (!world_has_yarns(w) || w->params->tearing == 0) return;
  find_strained(w);
  find_apart(w);
  w->work.transitions +=
      (uint32_t)w->params->links + w->particles - (uint32_t)w->params->particles;
}
