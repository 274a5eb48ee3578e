/* SPDX-License-Identifier: Apache-2.0 */
/* Broad phase of triangle self-collision: which vertices and triangles, and which edges, may collide in
 * a tick.
 *
 * A list of near pairs is kept from tick to tick, with more pairs than one tick needs, as Verlet lists
 * are. Triangles near each other at rest form a patch (patches.h). Each triangle has a budget of travel
 * relative to its patch, and each two neighbouring patches one relative to each other. When a budget is
 * used up, the pairs of that triangle, or of those two patches, are listed anew, as are those of
 * triangles that a tear or blade cut has changed. Each pair records how far its triangles and patches
 * may travel, together, before the two can collide: what separated them at their last test. Travel is
 * that of the farthest corner, less the mean path of the patch, so that the motion of a part of the
 * cloth as a whole costs nothing.
 *
 * A search ahead, for the constraints of the elastic steps, has paths by velocities, and cloth that
 * vibrates has velocities that lead far away. So what is stale there is listed for that search alone, by
 * boxes of these paths, behind the pairs that last.
 *
 * The pairs that may collide in this tick (active) are those that are no farther apart than the
 * thickness and their relative travel in this tick, and that neither an axis, nor the direction between
 * them or their triangles separates. That follows from the state and the paths of this tick alone. So the
 * list is no state: one with more pairs, or filled at another time, gives the same result to the last
 * bit. A world just opened has an empty one. */
#include "rt/self_collision/patches.h"
#include "rt/self_collision/triangle_collision.h"

enum {
  INSERTION_SORT_MAX = 24, /* active pairs of a triangle; more are sorted by a heap */
  SELF_TURN = 1021,        /* triangles from the first one of a tick to that of the next */
  SELF_TURNS = (1 << 20) - 1
};

/* ---- listing ---- */

static void list_cluster(fray_world *w, const triangle_box *box, uint32_t t, uint32_t first, uint32_t end,
                         int64_t allowance, int with_all) {
  for (uint32_t n = first; n < end; ++n) {
    const uint32_t other = w->tri.order[n];
    const int other_is_stale = w->tri.predicted_travel[other] == TRIANGLE_PAIR_STALE;
    if (!with_all && other >= t && (other == t || other_is_stale)) continue;
    const triangle_box *b = &w->tri.boxes[other];
    ++w->work.self_box_tests;
    if (!patches_overlap(box->low, box->high, b->low, b->high)) continue;
    const int64_t reach = patches_distance_min(w) + allowance + w->tri.travel[t].allowance +
                          w->tri.travel[other].allowance;
    triangle_collision_test(w, t, other, fx_saturate(reach));
  }
}

/* Lists the pairs of a triangle with those of a patch: with all of them, or without those stale
 * triangles that have a greater number, as they list the pair themselves. */
static void list_with_patch(fray_world *w, uint32_t t, uint32_t other, int with_all) {
  const triangle_patch *patch = &w->tri.patches[other];
  triangle_box box = w->tri.boxes[t];
  const int64_t allowance = patches_allowance(w, box.patch, other);
  patches_widen(&box.low, &box.high, allowance);
  if (!patches_overlap(box.low, box.high, patch->low, patch->high)) return;
  for (uint32_t n = patch->first; n < patch->end && w->tri.list->pool_short == 0; n += BOX_CLUSTER) {
    const box_cluster *cluster = &w->tri.clusters[n];
    const uint32_t end = n + BOX_CLUSTER < patch->end ? n + BOX_CLUSTER : patch->end;
    ++w->work.self_box_tests;
    if (patches_overlap(box.low, box.high, cluster->low, cluster->high))
      list_cluster(w, &box, t, n, end, allowance, with_all);
  }
}

/* Lists the pairs of a triangle with those of several patches, a bit each. */
static void list_triangle(fray_world *w, uint32_t t, uint64_t patches) {
  for (uint64_t left = patches; left != 0 && w->tri.list->pool_short == 0; left &= left - 1u)
    list_with_patch(w, t, 63u - fx_leading_zeros64(left & (~left + 1u)), 0);
}

static void list_patches(fray_world *w, uint32_t a, uint32_t b) {
  const triangle_patch *patch = &w->tri.patches[a];
  for (uint32_t n = patch->first; n < patch->end && w->tri.list->pool_short == 0; ++n)
    list_with_patch(w, w->tri.order[n], b, 1);
}

/* Returns 0 where the pool of pairs is full. */
static int list_stale(fray_world *w) {
  triangle_pair_list *l = w->tri.list;
  l->merge_rest = l->pool_short = 0;
  for (uint32_t n = 0; n < l->stale && l->pool_short == 0; ++n) {
    const uint32_t t = w->tri.stale[n];
    list_triangle(w, t, w->tri.patches[w->tri.boxes[t].patch].neighbours);
  }
  for (uint32_t a = 0; a < patches_count(w); ++a)
    for (uint32_t b = 0; b < a && l->pool_short == 0; ++b) {
      const patch_pair *pair = patches_pair(w, a, b);
      if (pair->allowance >= 0 && pair->predicted_travel == TRIANGLE_PAIR_STALE) list_patches(w, a, b);
    }
  return l->pool_short == 0;
}

/* Where the pool is too small: only pairs that may collide in this tick, triangle after triangle, from
 * another one in each tick. From the first triangle on that has no room for its pairs, only what touches is
 * merged. */
static void list_this_tick(fray_world *w) {
  triangle_pair_list *l = w->tri.list;
  patches_begin(w);
  l->valid = l->merge_rest = l->pool_short = l->active = 0;
  l->this_search_only = 1;
  patches_find_stale(w);
  patches_find_neighbours(w);
  const uint32_t triangles = triangles_in_use(w);
  const uint32_t first = ((uint32_t)state_tick(w->state) & SELF_TURNS) * SELF_TURN % triangles;
  for (uint32_t n = 0; n < triangles; ++n) {
    const uint32_t t = n < triangles - first ? first + n : first + n - triangles;
    const uint32_t pairs = l->pairs;
    const uint32_t active = l->active;
    const uint32_t own = w->tri.boxes[t].patch;
    uint64_t near = 0;
    for (uint32_t b = 0; b < patches_count(w); ++b)
      if (b == own || patches_pair(w, own, b)->allowance >= 0) near |= (uint64_t)1 << b;
    for (uint32_t attempt = 0; attempt < 2; ++attempt) {
      list_triangle(w, t, near);
      if (l->pool_short == 0) break;
      l->pool_short = 0;
      l->merge_rest = 1;
      l->pairs = pairs;
      l->active = active;
      world_fault(w, FRAY_FAULT_SELF_COLLISION_BUDGET);
    }
  }
}

/* Travel of both triangles, and of their patches, by the end of this tick. */
static int64_t predicted_of(const fray_world *w, const triangle_pair *pair) {
  const uint32_t a = w->tri.boxes[pair->triangle[0]].patch;
  const uint32_t b = w->tri.boxes[pair->triangle[1]].patch;
  return (int64_t)w->tri.predicted_travel[pair->triangle[0]] + w->tri.predicted_travel[pair->triangle[1]] +
         (a == b ? 0 : patches_pair(w, a, b)->predicted_travel);
}

/* Removes stale pairs from the list, or leaves them out of this search, and tests those that are due. */
static void check_list(fray_world *w) {
  triangle_pair_list *l = w->tri.list;
  uint32_t kept = 0;
  for (uint32_t n = 0; n < l->lasting; ++n) {
    const int64_t predicted = predicted_of(w, &w->tri.pairs[n]);
    const int is_stale = predicted >= TRIANGLE_PAIR_STALE; /* sums without a stale one are less */
    if (is_stale && l->this_search_only == 0) continue;
    if (kept != n) w->tri.pairs[kept] = w->tri.pairs[n];
    ++kept;
    if (!is_stale && predicted >= w->tri.pairs[kept - 1u].recheck_at) triangle_collision_check(w, kept - 1u);
  }
  l->pairs = l->lasting = kept;
}

/* ---- the order of active pairs: by first triangle, second triangle and kind ---- */

static uint64_t rank_of(const fray_world *w, uint32_t n) {
  const triangle_pair *pair = &w->tri.pairs[n];
  return (uint64_t)pair->triangle[1] << 8 | pair->kind;
}

static void heap_down(const fray_world *w, uint32_t *list, uint32_t at, uint32_t count) {
  const uint32_t pair = list[at];
  const uint64_t rank = rank_of(w, pair);
  uint32_t place = at;
  while (2u * place + 1u < count) {
    uint32_t child = 2u * place + 1u;
    if (child + 1u < count && rank_of(w, list[child + 1u]) > rank_of(w, list[child])) ++child;
    if (rank_of(w, list[child]) <= rank) break;
    list[place] = list[child];
    place = child;
  }
  list[place] = pair;
}

/* Pairs of one first triangle. */
static void sort_pairs(const fray_world *w, uint32_t *list, uint32_t count) {
  if (count <= INSERTION_SORT_MAX) {
    for (uint32_t n = 1; n < count; ++n) {
      const uint32_t pair = list[n];
      uint32_t at = n;
      for (; at > 0 && rank_of(w, list[at - 1u]) > rank_of(w, pair); --at) list[at] = list[at - 1u];
      list[at] = pair;
    }
    return;
  }
  for (uint32_t n = count / 2u; n > 0; --n) heap_down(w, list, n - 1u, count);
  for (uint32_t n = count - 1u; n > 0; --n) {
    const uint32_t last = list[n];
    list[n] = list[0];
    list[0] = last;
    heap_down(w, list, 0, n);
  }
}

static void sort_active(fray_world *w) {
  const uint32_t triangles = triangles_in_use(w);
  const uint32_t active = w->tri.list->active;
  uint32_t *counts = w->tri.pair_counts;
  uint32_t *unsorted = w->tri.active + w->capacity[POOL_TRIANGLE_PAIRS];
  uint32_t sum = 0;
  if (active == 0) return;

  for (uint32_t t = 0; t < triangles; ++t) counts[t] = 0;
  for (uint32_t n = 0; n < active; ++n) {
    unsorted[n] = w->tri.active[n];
    ++counts[w->tri.pairs[unsorted[n]].triangle[0]];
  }
  for (uint32_t t = 0; t < triangles; ++t) {
    sum += counts[t];
    counts[t] = sum - counts[t];
  }
  for (uint32_t n = 0; n < active; ++n)
    w->tri.active[counts[w->tri.pairs[unsorted[n]].triangle[0]]++] = unsorted[n];

  uint32_t first = 0;
  for (uint32_t t = 0; t < triangles; ++t) {
    sort_pairs(w, w->tri.active + first, counts[t] - first);
    first = counts[t];
  }
  FRAY_ASSERT(first == active);
}

int triangle_collision_find(fray_world *w, int is_ahead) {
  triangle_pair_list *l = w->tri.list;
  l->this_search_only = is_ahead ? 1u : 0u;
  l->active = l->out_of_range = l->merged_without_room = 0;
  if (l->valid == 0)
    patches_begin(w);
  else
    patches_follow(w);
  patches_find_stale(w);
  patches_find_neighbours(w);
  if (l->out_of_range != 0) {
    l->valid = 0;
    return 0;
  }

  check_list(w);
  if (!list_stale(w)) list_this_tick(w);
  if (l->this_search_only == 0) l->lasting = l->pairs;
  sort_active(w);
  FRAY_ASSERT(l->active <= l->pairs && l->pairs <= w->capacity[POOL_TRIANGLE_PAIRS]);
  w->work.self_pairs += l->active;
  return 1;
}
