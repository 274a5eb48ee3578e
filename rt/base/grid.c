/* SPDX-License-Identifier: Apache-2.0 */
/* Entries are sorted by bucket by counting, and in a bucket by number as they come in that order.
 * A pair that shares several cells is found in one of them: the one that holds the lower corner of
 * what the boxes have in common. Other cells with entries in the same bucket only cost visits. */
#include "rt/base/grid.h"

#include "rt/base/bytes.h"

typedef struct {
  int32_t low[3], high[3];
} cells;

static int32_t unit_down(int32_t v) { return fx_asr(v, FX_POSITION_BITS - GRID_BITS); }

grid_box grid_box_of(const sweep_point *points, uint32_t count, int32_t thickness, vec3 drift) {
  grid_box box;
  vec3 low = points[0].begin;
  vec3 high = low;
  for (uint32_t n = 0; n < count; ++n) {
    const vec3 begin = points[n].begin;
    const vec3 end = vec_make(fx_add_saturated(points[n].end.x, -drift.x),
                              fx_add_saturated(points[n].end.y, -drift.y),
                              fx_add_saturated(points[n].end.z, -drift.z));
    low = vec_make(fx_min(low.x, fx_min(begin.x, end.x)), fx_min(low.y, fx_min(begin.y, end.y)),
                   fx_min(low.z, fx_min(begin.z, end.z)));
    high = vec_make(fx_max(high.x, fx_max(begin.x, end.x)),
                    fx_max(high.y, fx_max(begin.y, end.y)),
                    fx_max(high.z, fx_max(begin.z, end.z)));
  }
  const int32_t half = thickness / 2 + 1;
  const int32_t lows[3] = {low.x, low.y, low.z};
  const int32_t highs[3] = {high.x, high.y, high.z};
  for (uint32_t k = 0; k < 3; ++k) {
    box.low[k] = (int16_t)fx_saturate16(unit_down(fx_add_saturated(lows[k], -half)));
    box.high[k] = (int16_t)fx_saturate16(unit_down(fx_add_saturated(highs[k], half)));
  }
  return box;
}

/* Returns 0 where there are too many. */
static int cells_of(const grid *g, const grid_box *box, cells *c) {
  uint32_t product = 1;
  for (uint32_t k = 0; k < 3; ++k) {
    c->low[k] = fx_asr(box->low[k], g->cell_bits);
    c->high[k] = fx_asr(box->high[k], g->cell_bits);
    const uint32_t wide = (uint32_t)(c->high[k] - c->low[k]) + 1u;
    if (wide > g->cells_most) return 0;
    product = fx_wrap_mul_u(product, wide);
    if (product > g->cells_most) return 0;
  }
  return 1;
}

static uint32_t bucket_of(const grid *g, int32_t x, int32_t y, int32_t z) {
  uint32_t v = fx_wrap_mul_u((uint32_t)x, 0x9E3779B1u) ^ (uint32_t)y;
  v = fx_wrap_mul_u(v, 0x85EBCA77u) ^ (uint32_t)z;
  v = fx_wrap_mul_u(v, 0xC2B2AE3Du);
  return (v ^ v >> 16) & (g->buckets - 1u);
}

/* Goes to the next cell; returns 0 after the last. */
static int next_cell(const cells *c, int32_t at[3]) {
  for (uint32_t k = 0; k < 3; ++k) {
    if (at[k] < c->high[k]) {
      ++at[k];
      return 1;
    }
    at[k] = c->low[k];
  }
  return 0;
}

/* Counts the entries of an element, or writes them. */
static void count_cells(grid *g, const cells *c) {
  int32_t at[3] = {c->low[0], c->low[1], c->low[2]};
  do ++g->bucket[bucket_of(g, at[0], at[1], at[2])];
  while (next_cell(c, at));
}
static void write_cells(grid *g, const cells *c, grid_id id) {
  int32_t at[3] = {c->low[0], c->low[1], c->low[2]};
  do g->entry[--g->bucket[bucket_of(g, at[0], at[1], at[2])]] = id;
  while (next_cell(c, at));
}
static uint32_t cell_count(const cells *c) {
  return (uint32_t)((c->high[0] - c->low[0] + 1) * (c->high[1] - c->low[1] + 1) *
                    (c->high[2] - c->low[2] + 1));
}

void grid_fill(grid *g, const grid_list *list) {
  cells c;
  uint32_t total = 0;
  bytes_zero(g->bucket, sizeof g->bucket[0] * ((size_t)g->buckets + 1u));
  for (uint32_t n = 0; n < list->count; ++n) {
    list->flags[n] = 0;
    if (!cells_of(g, &list->boxes[n], &c)) {
      list->flags[n] = GRID_LARGE;
    } else if (cell_count(&c) > g->entries - total) {
      list->flags[n] = GRID_ENTRIES;
    } else {
      total += cell_count(&c);
      count_cells(g, &c);
    }
  }
  /* to where each bucket ends, from where it is filled downwards, so that the last comes first */
  uint32_t sum = 0;
  for (uint32_t n = 0; n <= g->buckets; ++n) {
    sum += g->bucket[n];
    g->bucket[n] = sum;
  }
  for (uint32_t n = list->count; n > 0; --n) {
    if (list->flags[n - 1u] != 0 || !cells_of(g, &list->boxes[n - 1u], &c)) continue;
    write_cells(g, &c, (grid_id)(n - 1u));
  }
}

static inline int overlap(const grid_box *a, const grid_box *b) {
  return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] &&
         b->low[1] <= a->high[1] && a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
}
/* Whether what the two have in common begins in this cell. */
static inline int begins_in(const grid *g, const grid_box *a, const grid_box *b,
                            const int32_t at[3]) {
  return fx_asr(fx_max(a->low[0], b->low[0]), g->cell_bits) == at[0] &&
         fx_asr(fx_max(a->low[1], b->low[1]), g->cell_bits) == at[1] &&
         fx_asr(fx_max(a->low[2], b->low[2]), g->cell_bits) == at[2];
}
static int share_corner(const grid_list *la, uint32_t a, const grid_list *lb, uint32_t b) {
  if (la->corners == NULL || lb->corners == NULL) return 0;
  for (uint32_t n = 0; n < la->corners_each; ++n)
    for (uint32_t k = 0; k < lb->corners_each; ++k)
      if (la->corners[a * la->corners_each + n] == lb->corners[b * lb->corners_each + k]) return 1;
  return 0;
}

/* One element against those of its cells. */
typedef struct {
  const grid *g;
  const grid_list *list, *others;
  uint32_t a, visits, count;
  grid_id partner[GRID_PARTNERS]; /* sorted */
} hunt;

static void add_partner(hunt *h, grid_id b) {
  uint32_t at = h->count++;
  for (; at > 0 && h->partner[at - 1u] > b; --at) h->partner[at] = h->partner[at - 1u];
  h->partner[at] = b;
}

/* Returns 0 where it has seen as many as it may. */
static int visit_cell(hunt *h, const int32_t at[3]) {
  const grid *g = h->g;
  const grid_box *box = &h->others->boxes[h->a];
  const uint32_t bucket = bucket_of(g, at[0], at[1], at[2]);
  const uint32_t first = g->bucket[bucket];
  for (uint32_t n = g->bucket[bucket + 1u]; n > first; --n) {
    const grid_id b = g->entry[n - 1u];
    if (h->list == h->others && b <= h->a) return 1;
    if (h->visits == g->visits_most) return 0;
    ++h->visits;
    /* of other cells in the same bucket */
    if (n < g->bucket[bucket + 1u] && g->entry[n] == b) continue;
    if (!overlap(box, &h->list->boxes[b]) || !begins_in(g, box, &h->list->boxes[b], at) ||
        share_corner(h->others, h->a, h->list, b))
      continue;
    if (h->count == g->partners_most) return 0;
    add_partner(h, b);
  }
  return 1;
}

/* Whether all of its pairs are found. */
static int visit_cells(hunt *h, const cells *c) {
  int32_t at[3] = {c->low[0], c->low[1], c->low[2]};
  h->visits = 0;
  h->count = 0;
  do {
    if (!visit_cell(h, at)) return 0;
  } while (next_cell(c, at));
  return 1;
}

uint32_t grid_find(const grid *g, const grid_list *list, const grid_list *others, grid_pair *pairs,
                   uint32_t capacity) {
  hunt h;
  cells c;
  uint32_t count = 0;
  h.g = g;
  h.list = list;
  h.others = others;
  for (h.a = 0; h.a < others->count; ++h.a) {
    uint8_t *flags = &others->flags[h.a];
    if (list != others) *flags = 0;
    if (*flags != 0) continue;
    if (!cells_of(g, &others->boxes[h.a], &c)) {
      *flags = GRID_LARGE;
      continue;
    }
    if (!visit_cells(&h, &c)) *flags |= GRID_CROWDED;
    for (uint32_t n = 0; n < h.count; ++n) {
      if (count == capacity) {
        *flags |= GRID_PAIRS;
        break;
      }
      pairs[count].a = (grid_id)h.a;
      pairs[count].b = h.partner[n];
      ++count;
    }
  }
  return count;
}
