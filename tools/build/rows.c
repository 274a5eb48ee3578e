/* SPDX-License-Identifier: Apache-2.0 */
/* The order of the rows: from the held particles outwards (2009, section 4.1), coloured so that no
 * two rows of a batch share a particle, and in long runs. */
#include <stdlib.h>

#include "tools/build/draft.h"

/* Colours of links: 0 to 3 join crossings of one level, LINK_ACROSS and on two levels. */
enum { LINK_ACROSS = 4, LINK_COLOURS = 8 };
/* Particles of a band. Springs of each are batches of their own: workers divide batches by particles, and the
 * pieces of a run stand apart in one. */
enum { BAND = 1024 };
enum { RANK_LONG, RANK_SHORT, RANK_REST, RANK_SINGLE };

/* Rows along a contour: neighbours alternate; bend springs, which reach over one crossing, in pairs. */
static uint32_t colour_along(weave grid, uint32_t canonical, uint32_t a, uint32_t b) {
  const uint32_t i = a % grid.warps;
  const uint32_t j = a / grid.warps;
  if (canonical < weave_links(grid)) return b == a + 1 ? i % 2 : 2 + j % 2;
  if (canonical < weave_links(grid) + weave_bends(grid))
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

/* A link between two contours meets no other of its axis and levels but at a fork. Colours there go
 * by number, which is the same in the mirror image. */
static uint32_t link_across(const draft *d, uint32_t a, uint32_t b) {
  const uint32_t number = b == a + 1 ? a % d->grid.warps : a / d->grid.warps;
  return (uint32_t)LINK_ACROSS + (b == a + 1 ? 0u : 2u) + (is_fork(d, a, b) ? number % 2 : 0u);
}

/* Springs between contours, of the same way and reach, meet only where one begins and another ends. */
static uint32_t spring_across(const draft *d, uint32_t a, uint32_t b) {
  const uint32_t low = d->level[a] < d->level[b] ? a : b;
  const uint32_t high = a + b - low;
  const uint32_t warps = d->grid.warps;
  const uint32_t reach = d->level[high] - d->level[low];
  const uint32_t across = 1u + (high % warps > low % warps) - (high % warps < low % warps);
  const uint32_t along = 1u + (high / warps > low / warps) - (high / warps < low / warps);
  return 4 + (reach * 2 + d->level[low] / reach % 2) * 9 + across * 3 + along;
}

static draft_row make_row(const draft *d, uint32_t canonical) {
  draft_row r;
  uint32_t a;
  uint32_t b;
  weave_ends(d->grid, canonical, &a, &b);
  const uint32_t held = (uint32_t)(d->holder[a] != DRAFT_FREE) + (d->holder[b] != DRAFT_FREE);
  const uint32_t la = d->level[a];
  const uint32_t lb = d->level[b];
  /* springs act on velocities all at once: their order does not matter */
  r.ordered = canonical < weave_links(d->grid);
  r.kind = held == 0 ? BATCH_FREE : (held == 1 ? BATCH_HELD : BATCH_IDLE);
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

/* Links of all colours go outwards together, each colour some levels behind the one before it, so far
 * that they meet nowhere: one batch for each level, and not one for each level and colour. Links from
 * level to level lead: behind the others they hold a sheet less well. */
static void set_steps(draft_row *rows, uint32_t count) {
  static const uint32_t turn[LINK_COLOURS] = {4, 6, 0, 2, 1, 3, 5, 7};
  uint32_t used[LINK_COLOURS] = {0};
  uint32_t behind[LINK_COLOURS];
  for (uint32_t n = 0; n < count; ++n)
    if (rows[n].kind == BATCH_FREE) used[rows[n].colour] = 1;
  uint32_t levels = 0;
  for (uint32_t k = 0; k < LINK_COLOURS; ++k) {
    const uint32_t c = turn[k];
    behind[c] = levels + (c >= LINK_ACROSS ? used[c] : 0);
    levels += c < LINK_ACROSS ? used[c] : 2 * used[c];
  }
  for (uint32_t n = 0; n < count; ++n)
    if (rows[n].kind == BATCH_FREE) rows[n].step = rows[n].level + behind[rows[n].colour];
}

static int compare(uint32_t a, uint32_t b) { return (a > b) - (a < b); }

static uint32_t turn_of(uint32_t kind) { return kind == BATCH_HELD ? 0 : kind + 1; }

/* Held rows, then free ones, then idle ones; outwards, springs by bands. */
static int compare_batches(const draft_row *a, const draft_row *b) {
  const int order = compare(turn_of(a->kind), turn_of(b->kind));
  if (order != 0 || a->kind == BATCH_IDLE) return order;
  return a->step != b->step ? compare(a->step, b->step) : compare(a->band, b->band);
}

static int compare_rows(const void *left, const void *right) {
  const draft_row *a = left;
  const draft_row *b = right;
  int order = compare_batches(a, b);
  if (order == 0) order = compare(a->rank, b->rank);
  if (order == 0 && a->rank == RANK_SINGLE) order = compare(a->along_warp, b->along_warp);
  /* what the batch before moved last, last; springs, which have no order, with the particles */
  if (order == 0 && a->ordered) order = compare(b->level, a->level);
  if (order == 0) order = compare(a->i, b->i);
  return order != 0 ? order : compare(a->canonical, b->canonical);
}

/* Runs go in pieces of 16 rows and of 8, which wide kernels take whole, then what is left of them; rows of
 * shorter runs go last, where they are gathered. */
static uint32_t rank_of(uint32_t at, uint32_t length) {
  const uint32_t left = length % 8;
  if (at < length - length % 16) return RANK_LONG;
  if (at < length - left) return RANK_SHORT;
  return left < 3 ? RANK_SINGLE : RANK_REST;
}

static void rank_rows(draft_row *rows, uint32_t count) {
  uint32_t first = 0;
  for (uint32_t n = 1; n <= count; ++n) {
    if (n < count && compare_batches(&rows[n], &rows[n - 1]) == 0 &&
        rows[n].i == rows[n - 1].i + 1 && rows[n].j == rows[n - 1].j + 1)
      continue;
    for (uint32_t r = first; r < n; ++r) rows[r].rank = rank_of(r - first, n - first);
    first = n;
  }
}

static int write_batches(draft *d, uint32_t first, uint32_t end) {
  for (uint32_t n = first; n < end; ++n) {
    if (n == first || compare_batches(&d->rows[n - 1], &d->rows[n]) != 0) {
      if (d->batch_count == LIMIT_BATCHES)
        return draft_refuse(d, d->scene->sheet.line, "sheet: needs more than %d batches",
                            LIMIT_BATCHES);
      const row_batch begun = {(int32_t)n, 0, (int32_t)d->rows[n].kind};
      d->batches[d->batch_count++] = begun;
    }
    ++d->batches[d->batch_count - 1].count;
  }
  return 1;
}

int draft_rows(draft *d) {
  d->family_rows[FRAY_STRUCTURAL] = weave_links(d->grid);
  d->family_rows[FRAY_BEND] = weave_bends(d->grid);
  d->family_rows[FRAY_SHEAR] = weave_shears(d->grid);
  d->family_rows[DRAFT_SHADOWS] = d->scene->sheet.yarns != 0 ? d->family_rows[FRAY_SHEAR] : 0;
  uint32_t first = 0;
  for (uint32_t family = 0; family <= DRAFT_SHADOWS; ++family) {
    const uint32_t count = d->family_rows[family];
    const uint32_t batches_before = d->batch_count;
    const uint32_t above = family == DRAFT_SHADOWS ? d->family_rows[FRAY_SHEAR] : 0;
    for (uint32_t n = 0; n < count; ++n) {
      d->rows[first + n] = make_row(d, first + n - above);
      d->rows[first + n].canonical += above;
    }
    if (family == FRAY_STRUCTURAL) set_steps(d->rows + first, count);
    qsort(d->rows + first, count, sizeof *d->rows, compare_rows);
    rank_rows(d->rows + first, count);
    qsort(d->rows + first, count, sizeof *d->rows, compare_rows);
    if (!write_batches(d, first, first + count)) return 0;
    d->family_batches[family] = d->batch_count - batches_before;
    first += count;
  }
  return 1;
}
