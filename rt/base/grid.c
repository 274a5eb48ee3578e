/* SPDX-License-Identifier: Apache-2.0 */
/* Entries are sorted by bucket by counting, and in a bucket by number as they come in that order.
 * Each box has one entry, so a pair is met once. */
#include "rt/base/grid.h"

#include "rt/base/bytes.h"

typedef struct {
  int32_t low[3], high[3];
} cells;

/* From halves of a position, in which the sum of what is widest fits. */
static int32_t unit_down(int32_t half) { return fx_asr(half, FX_POSITION_BITS - 1 - GRID_BITS); }

grid_box grid_box_of(const sweep_point *points, uint32_t count, int32_t thickness, vec3 drift) {
  grid_box box;
  vec3 low = points[0].begin;
  vec3 high = low;
  for (uint32_t n = 0; n < count; ++n) {
    const vec3 begin = points[n].begin;
    const vec3 end = vec_sub(points[n].end, drift);
    low = vec_make(fx_min(low.x, fx_min(begin.x, end.x)), fx_min(low.y, fx_min(begin.y, end.y)),
                   fx_min(low.z, fx_min(begin.z, end.z)));
    high = vec_make(fx_max(high.x, fx_max(begin.x, end.x)), fx_max(high.y, fx_max(begin.y, end.y)),
                    fx_max(high.z, fx_max(begin.z, end.z)));
  }
  const int32_t skin = (thickness + 3) / 4; /* half of a half, upwards */
  const int32_t lows[3] = {low.x, low.y, low.z};
  const int32_t highs[3] = {high.x, high.y, high.z};
  for (uint32_t k = 0; k < 3; ++k) {
    box.low[k] = (int16_t)fx_saturate16(unit_down(fx_asr(lows[k], 1) - skin));
    box.high[k] = (int16_t)fx_saturate16(unit_down(fx_asr(highs[k], 1) + skin));
  }
  return box;
}

/* The cells of the lower corners of whatever overlaps the box; returns 0 where too many. */
static int cells_of(const grid *g, const grid_box *box, cells *c) {
  uint32_t product = 1;
  for (uint32_t k = 0; k < 3; ++k) {
    c->low[k] = fx_asr(box->low[k] - g->reach[k], g->cell_bits);
    c->high[k] = fx_asr(box->high[k], g->cell_bits);
    const uint32_t along = (uint32_t)(c->high[k] - c->low[k]) + 1u;
    if (along > g->cells_most) return 0;
    product = fx_wrap_mul_u(product, along);
    if (product > g->cells_most) return 0;
  }
  return 1;
}

/* Cells that follow each other along x have buckets that do. */
static uint32_t bucket_of(const grid *g, int32_t x, int32_t y, int32_t z) {
  uint32_t v = fx_wrap_mul_u((uint32_t)y, 0x9E3779B1u) ^ (uint32_t)z;
  v = fx_wrap_mul_u(v, 0x85EBCA77u);
  return (uint32_t)fx_wrap_add((int32_t)(v ^ v >> 16), x) & (g->buckets - 1u);
}

static uint32_t own_bucket(const grid *g, const grid_box *box) {
  return bucket_of(g, fx_asr(box->low[0], g->cell_bits), fx_asr(box->low[1], g->cell_bits),
                   fx_asr(box->low[2], g->cell_bits));
}
/* Wider than a cell along some axis. */
static int is_wide(const grid *g, const grid_box *box) {
  const int32_t most = ((int32_t)1 << g->cell_bits) - 1;
  return box->high[0] - box->low[0] > most || box->high[1] - box->low[1] > most ||
         box->high[2] - box->low[2] > most;
}

static void count_box(grid *g, const grid_box *box) {
  for (uint32_t k = 0; k < 3; ++k) g->reach[k] = fx_max(g->reach[k], box->high[k] - box->low[k]);
  ++g->bucket[own_bucket(g, box)];
}
static void list_wide(grid *g, const grid_list *list, uint32_t n) {
  if (g->wide_count == g->wide_most)
    list->flags[n] = GRID_LARGE;
  else
    g->wide[g->wide_count++] = (grid_id)n;
}

void grid_fill(grid *g, const grid_list *list) {
  uint32_t sum = 0;
  bytes_zero(g->bucket, sizeof g->bucket[0] * ((size_t)g->buckets + 1u));
  bytes_zero(g->reach, sizeof g->reach);
  g->wide_count = 0;
  for (uint32_t n = 0; n < list->count; ++n) {
    list->flags[n] = 0;
    if (is_wide(g, &list->boxes[n]))
      list_wide(g, list, n);
    else
      count_box(g, &list->boxes[n]);
  }
  /* to where each bucket ends, from where it is filled downwards, so that the last comes first */
  for (uint32_t n = 0; n <= g->buckets; ++n) {
    sum += g->bucket[n];
    g->bucket[n] = (grid_id)sum;
  }
  for (uint32_t n = list->count; n > 0; --n)
    if (!is_wide(g, &list->boxes[n - 1u]))
      g->entry[--g->bucket[own_bucket(g, &list->boxes[n - 1u])]] = (grid_id)(n - 1u);
}

static inline int overlap(const grid_box *a, const grid_box *b) {
  return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] &&
         b->low[1] <= a->high[1] && a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
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
  uint32_t a, from; /* the element; the least that it is held against */
  uint32_t visits;  /* left */
  uint32_t count;
  grid_id partner[GRID_PARTNERS]; /* sorted */
} hunt;

static void add_partner(hunt *h, grid_id b) {
  uint32_t at = h->count++;
  for (; at > 0 && h->partner[at - 1u] > b; --at) h->partner[at] = h->partner[at - 1u];
  h->partner[at] = b;
}

/* Returns 0 where it has as many as it may. */
static int meet(hunt *h, grid_id b) {
  if (share_corner(h->others, h->a, h->list, b)) return 1;
  if (h->count == h->g->partners_most) return 0;
  add_partner(h, b);
  return 1;
}

/* A row of cells: the entries of `count` buckets, which follow each other. What stands in another
 * row with the same buckets is left to that. Returns 0 where it has seen or found as many as it
 * may. */
static int visit_buckets(hunt *h, uint32_t bucket, uint32_t count, int32_t y, int32_t z) {
  const grid *g = h->g;
  const unsigned bits = g->cell_bits;
  const grid_box *boxes = h->list->boxes;
  const grid_box *box = &h->others->boxes[h->a];
  const grid_id *e = &g->entry[g->bucket[bucket]];
  const grid_id *end = &g->entry[g->bucket[bucket + count]];
  const int whole = (uint32_t)(end - e) <= h->visits;
  if (!whole) end = e + h->visits;
  h->visits -= (uint32_t)(end - e);
  for (; e < end; ++e) {
    const grid_id b = *e;
    if (b < h->from || !overlap(box, &boxes[b]) || fx_asr(boxes[b].low[1], bits) != y ||
        fx_asr(boxes[b].low[2], bits) != z)
      continue;
    if (!meet(h, b)) return 0;
  }
  return whole;
}
static int visit_row(hunt *h, const cells *c, int32_t y, int32_t z) {
  const uint32_t buckets = h->g->buckets;
  const uint32_t along = (uint32_t)(c->high[0] - c->low[0]) + 1u;
  const uint32_t count = along < buckets ? along : buckets;
  const uint32_t first = bucket_of(h->g, c->low[0], y, z);
  if (first + count <= buckets) return visit_buckets(h, first, count, y, z);
  return visit_buckets(h, first, buckets - first, y, z) &&
         visit_buckets(h, 0, first + count - buckets, y, z);
}
static int visit_wide(hunt *h) {
  const grid *g = h->g;
  for (uint32_t n = g->wide_count; n > 0; --n) {
    const grid_id b = g->wide[n - 1u];
    if (b < h->from) return 1;
    if (overlap(&h->others->boxes[h->a], &h->list->boxes[b]) && !meet(h, b)) return 0;
  }
  return 1;
}

/* Whether all of its pairs are found. */
static int visit_cells(hunt *h, const cells *c) {
  for (int32_t z = c->low[2]; z <= c->high[2]; ++z)
    for (int32_t y = c->low[1]; y <= c->high[1]; ++y)
      if (!visit_row(h, c, y, z)) return 0;
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
  for (uint32_t a = 0; a < others->count; ++a) {
    uint8_t *flags = &others->flags[a];
    h.a = a;
    if (list != others) *flags = 0;
    if (*flags != 0) continue;
    if (!cells_of(g, &others->boxes[a], &c)) {
      *flags = GRID_LARGE;
      continue;
    }
    h.from = list == others ? a + 1u : 0;
    h.visits = g->visits_most;
    h.count = 0;
    if (!visit_wide(&h) || !visit_cells(&h, &c)) *flags |= GRID_CROWDED;
    for (uint32_t n = 0; n < h.count; ++n) {
      if (count == capacity) {
        *flags |= GRID_PAIRS;
        break;
      }
      pairs[count].a = (grid_id)a;
      pairs[count].b = h.partner[n];
      ++count;
    }
  }
  return count;
}
