/* SPDX-License-Identifier: Apache-2.0 */
/* From whole crossings to yarns (Metaaphanon 2009, section 3.4). A spring over its transition strain marks
 * both of its ends and their immediate neighbours to split. A split crossing whose yarns are farther apart
 * than loose_max (disconnect_distance here) disconnects. In the paper splitting then spreads along both
 * yarns, up to and including the first crossing where the weave is opposite, to a broken link, or before an
 * attached crossing. Here that is a setting: else a crossing splits by what it carries.
 *
 * This stage marks crossings as pending; crossing_split_apply() splits a bounded number a tick, in order.
 * The number that disconnects in a tick has the same bound, in the order in which they split; the others
 * are found again in the next tick. */
#include "rt/simd/simd.h"
#include "rt/state/crossing.h"
#include "rt/woven/woven.h"
#include "rt/woven/woven_links.h"
#include "rt/woven/yarn_slip.h"

static void mark(fray_world *w, uint32_t crossing) {
  FRAY_ASSERT(crossing < w->capacity[POOL_CROSSINGS]);
  const uint32_t now = w->woven.crossing_state[crossing]; /* the whole byte: one already pending is skipped */
  if ((now != FRAY_WHOLE && now != FRAY_CONNECTED) || crossing_is_attached(w, crossing)) return;
  if (now == FRAY_WHOLE && w->p.count == w->capacity[POOL_PARTICLES]) {
    world_fault(w, FRAY_FAULT_PARTICLES_FULL);
    return;
  }
  crossing_set_pending(w, crossing, 1);
}

static void mark_around(fray_world *w, uint32_t crossing) {
  FRAY_ASSERT(crossing < w->capacity[POOL_CROSSINGS]);
  const yarn_grid_neighbours around = yarn_grid_neighbours_at(world_yarn_grid(w), crossing);
  mark(w, crossing);
  for (uint32_t direction = 0; direction < 4; ++direction) mark(w, around.next[direction]);
}

static int is_broken(const fray_world *w, uint32_t link) {
  return w->woven.spring_kind[w->woven.spring_of[link]] == SPRING_DEAD;
}

__attribute__((noinline)) static void spread_splits(fray_world *w, uint32_t crossing) {
  const int warp_over = crossing_warp_over(w, crossing);
  for (uint32_t direction = 0; direction < 4; ++direction) {
    uint32_t at = crossing;
    uint32_t next;
    uint32_t link;
    while (yarn_grid_step(world_yarn_grid(w), at, direction, &next, &link) && !is_broken(w, link) &&
           !crossing_is_attached(w, next)) {
      mark(w, next);
      if (crossing_warp_over(w, next) != warp_over) break;
      at = next;
    }
  }
}

__attribute__((noinline)) static void find_strained(fray_world *w) {
  const int32_t strain_min = w->woven.yarn_constants->split_min;
  const link_view view = woven_links(w);
  const uint32_t end = (uint32_t)w->params->links;
  for (uint32_t spring = 0; spring < end; ++spring) {
    spring = simd_tear_scan(w->kernel, view, strain_min, spring, end);
    if (spring == end) break;
    const uint32_t kind = w->woven.spring_kind[spring];
    if (kind == SPRING_DEAD) continue;
    const int32_t rest = w->woven.link_classes[kind & SPRING_CLASS].rest;
    const vec3 d =
        vec_sub(world_position(w, w->woven.spring_j[spring]), world_position(w, w->woven.spring_i[spring]));
    const uint64_t n = vec_squared(d);
    if (n <= link_stretched_squared(rest, strain_min)) continue; /* no spring's own strain is below it */
    if (n <= link_stretched_squared(rest, world_split_strain(w, spring))) continue;
    mark_around(w, w->woven.crossing_of[w->woven.spring_i[spring]]);
    mark_around(w, w->woven.crossing_of[w->woven.spring_j[spring]]);
  }
}

/* bound: the squared distance from which a loose crossing disconnects. */
static int is_apart(const fray_world *w, uint32_t c, uint64_t bound) {
  const uint32_t n = crossing_contact(w, c);
  yarn_touch touch;
  if ((w->woven.crossing_state[c] & CROSSING_LEFT) != 0 || !yarn_touch_at(w, n, &touch)) return 1;
  const vec3 particles = vec_sub(world_position(w, w->woven.warp_particle[c]),
                                 world_position(w, w->woven.crossing_particle[c]));
  return vec_squared(w->woven.yarn_constants->disconnect_by_particles != 0 ? particles : touch.gap) > bound;
}

/* Half a spacing off its crossing a contact is none of the corners of four cells any more: from then on their
 * diagonals, which would gain energy if it came back, are released. */
static void release_slid(fray_world *w, uint32_t c) {
  const yarn_contact *k = &w->woven.contacts[crossing_contact(w, c)];
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t home[2] = {yarn_place_of(c % warps), yarn_place_of(c / warps)};
  for (uint32_t axis = 0; axis < 2; ++axis)
    if (yarn_places_apart(k->place[axis], home[axis]) > (uint32_t)YARN_SLIP_NEAR)
      crossing_release_diagonals(w, c);
}

/* Where a contact is pushed against a whole crossing by more than friction holds of itself, that one splits
 * too: else the yarn would jam there. */
static void mark_jammed(fray_world *w, uint32_t c) {
  const uint32_t n = crossing_contact(w, c);
  const yarn_contact_step *t = &w->woven.contact_steps[n];
  for (uint32_t direction = 0; direction < 4; ++direction) {
    const uint32_t neighbour = t->neighbour[direction];
    if (neighbour == YARN_NEIGHBOUR_NONE || (neighbour & YARN_NEIGHBOUR_WHOLE) == 0) continue;
    if (YARN_SLIP_NEAR - yarn_slip_distance(w, n, direction) <= t->limit[direction / 2u]) continue;
    const uint32_t k = neighbour & (index_t)~YARN_NEIGHBOUR_WHOLE;
    const uint32_t warps = (uint32_t)w->params->warps;
    mark(w, direction < 2u ? c / warps * warps + k : k * warps + c % warps);
  }
}

/* Beside split crossings: whole ones that carry more than friction holds. Of elastic yarns: projection knows
 * a tension to a few percent of a yarn's strength only, which is more than most friction. */
static void mark_sliding(fray_world *w, uint32_t c) {
  const yarn_grid_neighbours around = yarn_grid_neighbours_at(world_yarn_grid(w), c);
  for (uint32_t direction = 0; direction < 4; ++direction) {
    const uint32_t next = around.next[direction];
    if (w->woven.crossing_state[next] != FRAY_WHOLE || crossing_is_attached(w, next)) continue;
    if (!yarn_grip_holds(w, next)) mark(w, next);
  }
}

__attribute__((noinline)) static void find_apart(fray_world *w) {
  const uint64_t bound = fx_square(w->woven.yarn_constants->disconnect_distance);
  uint32_t left = w->capacity[POOL_SPLITS];
  for (uint32_t p = (uint32_t)w->params->particles; p < w->p.count; ++p) {
    const uint32_t c = w->woven.crossing_of[p];
    FRAY_ASSERT(c < w->capacity[POOL_CROSSINGS] && w->woven.warp_particle[c] == p);
    if (world_has_elastic_yarns(w)) mark_sliding(w, c);
    if (crossing_state_at(w, c) != FRAY_LOOSE) continue;
    release_slid(w, c);
    if ((w->woven.crossing_state[c] & CROSSING_LEFT) == 0) mark_jammed(w, c);
    if (!is_apart(w, c, bound)) continue;
    if (left == 0) {
      world_fault(w, FRAY_FAULT_SPLIT_BUDGET);
      return;
    }
    --left;
    crossing_set_state(w, c, FRAY_DISCONNECTED);
    if (w->woven.yarn_constants->spread_splits != 0) spread_splits(w, c);
  }
}

void crossing_transition_find(fray_world *w) {
  FRAY_ASSERT(world_has_yarns(w));
  FRAY_ASSERT(w->p.count >= (uint32_t)w->params->particles && w->p.count <= w->capacity[POOL_PARTICLES]);
  if (w->params->tearing == 0) return;
  find_strained(w);
  find_apart(w);
  w->work.transitions += (uint32_t)w->params->links + w->p.count - (uint32_t)w->params->particles;
}
