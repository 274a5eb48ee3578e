/* SPDX-License-Identifier: Apache-2.0 */
/* The order of the springs: from the attached particles outwards (2009, section 4.1), coloured such that no
 * two springs of a batch share a particle, and in long runs. */
#include <stdlib.h>

#include "tools/scene_compiler/draft.h"

/* Colours of links: 0 to 3 join crossings of one level, LINK_ACROSS and on two levels. */
enum { LINK_ACROSS = 4, LINK_COLOURS = 8 };
/* Particles of a band. Each band has its own batches of springs: workers divide batches by particles. */
enum { BAND = 1024 };
enum { RANK_LONG, RANK_SHORT, RANK_REST, RANK_SINGLE };

/* Springs along a contour: neighbours alternate; bend springs, which skip a crossing, in pairs. */
static uint32_t colour_along(yarn_grid grid, uint32_t canonical, uint32_t a, uint32_t b) {
  const uint32_t i = a % grid.warps;
  const uint32_t j = a / grid.warps;
  if (canonical < yarn_grid_links(grid)) return b == a + 1 ? i % 2 : 2 + j % 2;
  if (canonical < yarn_grid_links(grid) + yarn_grid_bends(grid))
    return b == a + 2 ? i / 2 % 2 : 2 + j / 2 % 2;
  return b > a + grid.warps ? i % 2 : 2 + i % 2; /* diagonals: rising, falling */
}

/* Whether one end has two links of this axis to the other end's level. */
static int is_fork(const draft *d, uint32_t a, uint32_t b) {
  const uint32_t axis = b == a + 1 ? 0 : 2;
  uint32_t near_a[4];
  uint32_t near_b[4];
  draft_neighbours(d, a, near_a);
  draft_neighbours(d, b, near_b);
  return d->level[near_a[axis]] == d->level[b] || d->level[near_b[axis + 1]] == d->level[a];
}

/* A link between two contours shares a particle with others of its axis and levels only at a fork. Colours
 * there alternate by number, which is symmetric. */
static uint32_t link_across(const draft *d, uint32_t a, uint32_t b) {
  const uint32_t number = b == a + 1 ? a % d->grid.warps : a / d->grid.warps;
  return (uint32_t)LINK_ACROSS + (b == a + 1 ? 0u : 2u) + (is_fork(d, a, b) ? number % 2 : 0u);
}

/* Springs between contours, of one direction and length, touch only end to start. */
static uint32_t spring_across(const draft *d, uint32_t a, uint32_t b) {
  const uint32_t low = d->level[a] < d->level[b] ? a : b;
  const uint32_t high = a + b - low;
  const uint32_t warps = d->grid.warps;
  const uint32_t reach = d->level[high] - d->level[low];
  const uint32_t across = 1u + (high % warps > low % warps) - (high % warps < low % warps);
  const uint32_t along = 1u + (high / warps > low / warps) - (high / warps < low / warps);
  return 4 + (reach * 2 + d->level[low] / reach % 2) * 9 + across * 3 + along;
}

static draft_spring make_draft_spring(const draft *d, uint32_t canonical) {
  draft_spring r;
  uint32_t a;
  uint32_t b;
  yarn_grid_ends(d->grid, canonical, &a, &b);
  const uint32_t held = (uint32_t)(d->holder[a] != DRAFT_FREE) + (d->holder[b] != DRAFT_FREE);
  const uint32_t la = d->level[a];
  const uint32_t lb = d->level[b];
  /* bend and shear springs act on velocities at once: their order does not matter */
  r.ordered = canonical < yarn_grid_links(d->grid);
  r.kind = held == 0 ? BATCH_FREE : (held == 1 ? BATCH_ATTACHED : BATCH_INACTIVE);
  r.canonical = canonical;
  r.i = d->particle[a] < d->particle[b] ? d->particle[a] : d->particle[b];
  r.j = d->particle[a] < d->particle[b] ? d->particle[b] : d->particle[a];
  r.colour = la == lb  ? colour_along(d->grid, canonical, a, b)
             : r.ordered ? link_across(d, a, b)
                       : spring_across(d, a, b);
  r.level = la < lb ? la : lb;
  r.step = r.colour;
  r.band = r.ordered ? 0 : r.j / BAND;
  r.rank = RANK_LONG;
  r.along_warp = a / d->grid.warps != b / d->grid.warps;
  return r;
}

/* Links of all colours proceed outwards together, each colour as many levels behind the one before as keeps
 * them apart: one batch for each level instead of one for each level and colour. Links from level to level
 * come first: behind the others they converge more slowly. */
static void set_steps(draft_spring *springs, uint32_t count) {
  static const uint32_t turn[LINK_COLOURS] = {4, 6, 0, 2, 1, 3, 5, 7};
  uint32_t used[LINK_COLOURS] = {0};
  uint32_t behind[LINK_COLOURS];
  for (uint32_t n = 0; n < count; ++n)
    if (springs[n].kind == BATCH_FREE) used[springs[n].colour] = 1;
  uint32_t levels = 0;
  for (uint32_t k = 0; k < LINK_COLOURS; ++k) {
    const uint32_t c = turn[k];
    behind[c] = levels + (c >= LINK_ACROSS ? used[c] : 0);
    levels += c < LINK_ACROSS ? used[c] : 2 * used[c];
  }
  for (uint32_t n = 0; n < count; ++n)
    if (springs[n].kind == BATCH_FREE) springs[n].step = springs[n].level + behind[springs[n].colour];
}

static int compare(uint32_t a, uint32_t b) { return (a > b) - (a < b); }

static uint32_t turn_of(uint32_t kind) { return kind == BATCH_ATTACHED ? 0 : kind + 1; }

/* Springs with an attached end, then free ones, then inactive ones; outwards, bend and shear by bands. */
static int compare_batches(const draft_spring *a, const draft_spring *b) {
  const int order = compare(turn_of(a->kind), turn_of(b->kind));
  if (order != 0 || a->kind == BATCH_INACTIVE) return order;
  return a->step != b->step ? compare(a->step, b->step) : compare(a->band, b->band);
}

static int compare_springs(const void *left, const void *right) {
  const draft_spring *a = left;
  const draft_spring *b = right;
  int order = compare_batches(a, b);
  if (order == 0) order = compare(a->rank, b->rank);
  if (order == 0 && a->rank == RANK_SINGLE) order = compare(a->along_warp, b->along_warp);
  /* what the batch before moved last, last; bend and shear springs in the order of particles */
  if (order == 0 && a->ordered) order = compare(b->level, a->level);
  if (order == 0) order = compare(a->i, b->i);
  return order != 0 ? order : compare(a->canonical, b->canonical);
}

/* Runs are cut into pieces of 16 and of 8 springs, which SIMD kernels take at once, then the rest; springs of
 * shorter runs come last, where they are gathered. */
static uint32_t rank_of(uint32_t at, uint32_t length) {
  const uint32_t left = length % 8;
  if (at < length - length % 16) return RANK_LONG;
  if (at < length - left) return RANK_SHORT;
  return left < 3 ? RANK_SINGLE : RANK_REST;
}

static void rank_springs(draft_spring *springs, uint32_t count) {
  uint32_t first = 0;
  for (uint32_t n = 1; n <= count; ++n) {
    if (n < count && compare_batches(&springs[n], &springs[n - 1]) == 0 &&
        springs[n].i == springs[n - 1].i + 1 && springs[n].j == springs[n - 1].j + 1)
      continue;
    for (uint32_t r = first; r < n; ++r) springs[r].rank = rank_of(r - first, n - first);
    first = n;
  }
}

static int write_batches(draft *d, uint32_t first, uint32_t end) {
  for (uint32_t n = first; n < end; ++n) {
    if (n == first || compare_batches(&d->springs[n - 1], &d->springs[n]) != 0) {
      if (d->batch_count == MAX_BATCHES)
        return draft_refuse(d, d->scene->source.block[BLOCK_CLOTH],
                            "found cloth that needs more than %d batches of springs, expected fewer "
                            "crossings or "
                            "fewer attached ones",
                            MAX_BATCHES);
      const spring_batch begun = {(int32_t)n, 0, (int32_t)d->springs[n].kind};
      d->batches[d->batch_count++] = begun;
    }
    ++d->batches[d->batch_count - 1].count;
  }
  return 1;
}

int draft_make_springs(draft *d) {
  d->springs_of_kind[FRAY_STRUCTURAL] = yarn_grid_links(d->grid);
  d->springs_of_kind[FRAY_BEND] = yarn_grid_bends(d->grid);
  d->springs_of_kind[FRAY_SHEAR] = yarn_grid_shears(d->grid);
  d->springs_of_kind[DRAFT_SHADOWS] = d->scene->woven.yarns != 0 ? d->springs_of_kind[FRAY_SHEAR] : 0;
  uint32_t first = 0;
  for (uint32_t family = 0; family <= DRAFT_SHADOWS; ++family) {
    const uint32_t count = d->springs_of_kind[family];
    const uint32_t batches_before = d->batch_count;
    const uint32_t above = family == DRAFT_SHADOWS ? d->springs_of_kind[FRAY_SHEAR] : 0;
    for (uint32_t n = 0; n < count; ++n) {
      d->springs[first + n] = make_draft_spring(d, first + n - above);
      d->springs[first + n].canonical += above;
    }
    if (family == FRAY_STRUCTURAL) set_steps(d->springs + first, count);
    qsort(d->springs + first, count, sizeof *d->springs, compare_springs);
    rank_springs(d->springs + first, count);
    qsort(d->springs + first, count, sizeof *d->springs, compare_springs);
    if (!write_batches(d, first, first + count)) return 0;
    d->batches_of_kind[family] = d->batch_count - batches_before;
    first += count;
  }
  return 1;
}
