/* SPDX-License-Identifier: Apache-2.0 */
/* The order of everything: particles by distance from the held ones, rows from the held particles
 * outwards (2009, section 4.1), coloured so that no two rows of a batch share a particle. */
#include <stdlib.h>

#include "tools/build/draft.h"

/* Breadth first over the grid from all held crossings; without any, everything is level 0. */
static void find_levels(draft *d, uint32_t *queue) {
  uint32_t head = 0;
  uint32_t tail = 0;
  for (uint32_t c = 0; c < d->crossings; ++c) {
    d->level[c] = d->held == 0 || d->holder[c] != DRAFT_FREE ? 0 : UINT32_MAX;
    if (d->level[c] == 0) queue[tail++] = c;
  }
  while (head < tail) {
    const uint32_t c = queue[head++];
    const uint32_t i = c % d->grid.warps;
    const uint32_t j = c / d->grid.warps;
    const uint32_t near[4] = {i > 0 ? c - 1 : c, i + 1 < d->grid.warps ? c + 1 : c,
                              j > 0 ? c - d->grid.warps : c,
                              j + 1 < d->grid.wefts ? c + d->grid.warps : c};
    for (uint32_t n = 0; n < 4; ++n)
      if (d->level[near[n]] == UINT32_MAX) {
        d->level[near[n]] = d->level[c] + 1;
        queue[tail++] = near[n];
      }
  }
}

/* Held crossings first, by body; then by level; then as they stand in the grid. */
int draft_order(draft *d) {
  uint32_t *queue = d->crossing; /* filled below; scratch until then */
  find_levels(d, queue);
  uint32_t level_max = 0;
  for (uint32_t c = 0; c < d->crossings; ++c)
    if (d->level[c] > level_max) level_max = d->level[c];
  uint32_t next = 0;
  for (uint32_t b = 0; b < d->bodies; ++b)
    for (uint32_t c = 0; c < d->crossings; ++c)
      if (d->holder[c] == b) d->particle[c] = next++;
  uint32_t *start = calloc((size_t)level_max + 2, sizeof *start);
  if (start == NULL) return draft_refuse(d, 0, "out of memory");
  for (uint32_t c = 0; c < d->crossings; ++c)
    if (d->holder[c] == DRAFT_FREE) ++start[d->level[c] + 1];
  start[0] = next;
  for (uint32_t n = 0; n <= level_max; ++n) start[n + 1] += start[n];
  for (uint32_t c = 0; c < d->crossings; ++c)
    if (d->holder[c] == DRAFT_FREE) d->particle[c] = start[d->level[c]]++;
  free(start);
  for (uint32_t c = 0; c < d->crossings; ++c) d->crossing[d->particle[c]] = c;
  return 1;
}

/* Neighbours along a yarn alternate; bend springs, which reach over one crossing, in pairs. */
static uint32_t colour_of(weave grid, uint32_t canonical) {
  const uint32_t links = weave_links(grid);
  const uint32_t bends = weave_bends(grid);
  uint32_t a;
  uint32_t b;
  weave_ends(grid, canonical, &a, &b);
  const uint32_t i = a % grid.warps;
  const uint32_t j = a / grid.warps;
  if (canonical < links) return b == a + 1 ? i % 2 : 2 + j % 2;
  if (canonical < links + bends) return b == a + 2 ? i / 2 % 2 : 2 + j / 2 % 2;
  return b > a + grid.warps ? i % 2 : 2 + i % 2; /* diagonals: rising, falling */
}

static draft_row make_row(const draft *d, uint32_t canonical) {
  draft_row r;
  uint32_t a;
  uint32_t b;
  weave_ends(d->grid, canonical, &a, &b);
  const uint32_t held = (uint32_t)(d->holder[a] != DRAFT_FREE) + (d->holder[b] != DRAFT_FREE);
  r.kind = held == 0 ? BATCH_FREE : (held == 1 ? BATCH_HELD : BATCH_IDLE);
  r.canonical = canonical;
  r.i = d->particle[a] < d->particle[b] ? d->particle[a] : d->particle[b];
  r.j = d->particle[a] < d->particle[b] ? d->particle[b] : d->particle[a];
  r.colour = colour_of(d->grid, canonical);
  /* bend and shear act on velocities all at once: their order does not matter */
  const int ordered = canonical < weave_links(d->grid);
  const uint32_t la = d->level[a];
  const uint32_t lb = d->level[b];
  r.least = ordered ? (la < lb ? la : lb) : 0;
  r.sum = ordered ? la + lb : 0;
  return r;
}

static int compare(uint32_t a, uint32_t b) { return (a > b) - (a < b); }

static uint32_t turn_of(uint32_t kind) { return kind == BATCH_HELD ? 0 : kind + 1; }

static int same_batch(const draft_row *a, const draft_row *b) {
  return a->kind == b->kind &&
         (a->kind == BATCH_IDLE ||
          (a->least == b->least && a->sum == b->sum && a->colour == b->colour));
}

/* Held rows, then free ones, then idle ones; outwards by level; by colour; by place in memory. */
static int compare_rows(const void *left, const void *right) {
  const draft_row *a = left;
  const draft_row *b = right;
  int order = compare(turn_of(a->kind), turn_of(b->kind));
  if (order == 0 && a->kind != BATCH_IDLE) {
    order = compare(a->least, b->least);
    if (order == 0) order = compare(a->sum, b->sum);
    if (order == 0) order = compare(a->colour, b->colour);
  }
  if (order == 0) order = compare(a->i, b->i);
  return order != 0 ? order : compare(a->canonical, b->canonical);
}

int draft_rows(draft *d) {
  d->family_rows[FRAY_STRUCTURAL] = weave_links(d->grid);
  d->family_rows[FRAY_BEND] = weave_bends(d->grid);
  d->family_rows[FRAY_SHEAR] = weave_shears(d->grid);
  uint32_t first = 0;
  for (uint32_t family = 0; family < 3; ++family) {
    const uint32_t end = first + d->family_rows[family];
    const uint32_t batches_before = d->batch_count;
    for (uint32_t n = first; n < end; ++n) d->rows[n] = make_row(d, n);
    qsort(d->rows + first, end - first, sizeof *d->rows, compare_rows);
    for (uint32_t n = first; n < end; ++n) {
      if (n == first || !same_batch(&d->rows[n - 1], &d->rows[n])) {
        if (d->batch_count == LIMIT_BATCHES)
          return draft_refuse(d, d->scene->sheet.line, "sheet: needs more than %d batches",
                              LIMIT_BATCHES);
        d->batches[d->batch_count].first = (int32_t)n;
        d->batches[d->batch_count].count = 0;
        d->batches[d->batch_count++].held = (int32_t)d->rows[n].kind;
      }
      ++d->batches[d->batch_count - 1].count;
    }
    d->family_batches[family] = d->batch_count - batches_before;
    first = end;
  }
  return 1;
}
