/* SPDX-License-Identifier: Apache-2.0 */
/* Which vertices and triangles, and which sides, may meet in a tick.
 *
 * A list of all that is near each other is kept from tick to tick, by more than a tick needs; each pair in it
 * says how far the sheet may go until the two can meet, by what separated them when they were looked at last.
 * What everything moves by brings nothing nearer, so ways count less the mean of all.
 *
 * The list is no state. What is missing in it, or passed over, is so far apart on this tick's ways that a sweep
 * would find nothing; so a list that has more, or was made at another time, gives the same result to the last
 * bit. It is made anew when something has gone too far, when the sheet has torn, and in a world just opened.
 *
 *   distance   of two that all have gone from by d along each axis is less by at most 2 root 3 d
 *   looks      of a sweep at time t go by the direction in which the two are nearest then. With 2 root 3 times
 *              the ways of the tick between them, twice (to t, and from there), and a margin for what sweeps
 *              round, that direction separates them all the way
 *
 * Boxes of triangles stand in cells as wide as the widest of them, so each looks into 27. */
#include "rt/stage/layers.h"

enum {
  PER_STEP = 7,    /* 2 root 3, rounded up: halves */
  FAR = 64,        /* lu: nothing stands lower */
  MARGIN_BITS = 3, /* what sweeps may be wrong by: that share of the least height that cuts leave */
  ROOM = 3,        /* of these heights: what is listed beyond what a tick needs */
  SHORT = 24       /* segments of the list that are put in order one by one */
};

/* ---- ways ---- */

typedef struct {
  int32_t low[3], high[3];
} extent;

static void extend(extent *e, vec3 from, vec3 to) {
  const int32_t moved[3] = {fx_sub(to.x, from.x), fx_sub(to.y, from.y), fx_sub(to.z, from.z)};
  for (uint32_t k = 0; k < 3; ++k) {
    e->low[k] = fx_min(e->low[k], moved[k]);
    e->high[k] = fx_max(e->high[k], moved[k]);
  }
}
/* From the middle of all. */
static int32_t farthest(const extent *e) {
  int64_t most = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    const int64_t wide = (int64_t)e->high[k] - e->low[k];
    if (wide > most) most = wide;
  }
  return fx_saturate(most / 2 + 1);
}
static const extent nothing = {{INT32_MAX, INT32_MAX, INT32_MAX}, {-INT32_MAX, -INT32_MAX, -INT32_MAX}};

static int32_t spread_of_ways(const fray_world *w) {
  extent e = nothing;
  for (uint32_t p = 0; p < w->particles; ++p) extend(&e, w->ways[p].begin, w->ways[p].end);
  return farthest(&e);
}
static int32_t spread_since(const fray_world *w) {
  extent e = nothing;
  for (uint32_t p = 0; p < w->particles; ++p) extend(&e, w->layers_from[p], w->ways[p].begin);
  return farthest(&e);
}

static int is_same_sheet(const fray_world *w) {
  return w->listed.particles == w->particles && w->listed.topology[0] == w->state->topology[0] &&
         w->listed.topology[1] == w->state->topology[1];
}

void layers_went(fray_world *w) {
  extent e = nothing;
  layer_list *l = &w->listed;
  if (l->kept == 0) return;
  if (!is_same_sheet(w)) {
    l->kept = 0;
    return;
  }
  for (uint32_t p = 0; p < w->particles; ++p) extend(&e, w->ways[p].begin, world_position(w, p));
  l->path = fx_saturate((int64_t)l->path + farthest(&e));
}

/* Two that are farther apart do not meet, if they do not go anywhere. */
static int64_t least_apart(const fray_world *w) {
  return (int64_t)w->selves->thickness + 4 * (int64_t)w->selves->slack +
         fx_asr(w->sheet.params->height_min, MARGIN_BITS);
}
/* Nor in this tick, if all has gone no farther since. */
static int64_t least_reach(const fray_world *w, int64_t gone) {
  return least_apart(w) + PER_STEP * (gone + 2 * (int64_t)w->listed.spread) / 2;
}

/* ---- boxes and cells ---- */

static uint32_t bits_of_own(const fray_world *w, uint32_t t) {
  const sheet_triangle *f = &w->sheet.triangle[t];
  uint32_t own = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    if (w->sheet.fan[f->v[k]] == t) own |= 1u << k;
    if (f->across[k] >= t) own |= 8u << k;
  }
  return own;
}

/* Returns the longest side of it. */
static int32_t box_of(fray_world *w, uint32_t t, int32_t half) {
  const row_id *v = w->sheet.triangle[t].v;
  layer_box *b = &w->layer_boxes[t];
  int32_t widest = 0;
  const vec3 a = w->ways[v[0]].begin;
  const vec3 c = w->ways[v[1]].begin;
  const vec3 d = w->ways[v[2]].begin;
  const int32_t at[3][3] = {{a.x, c.x, d.x}, {a.y, c.y, d.y}, {a.z, c.z, d.z}};
  for (uint32_t k = 0; k < 3; ++k) {
    b->low[k] = fx_saturate((int64_t)fx_min(fx_min(at[k][0], at[k][1]), at[k][2]) - half);
    b->high[k] = fx_saturate((int64_t)fx_max(fx_max(at[k][0], at[k][1]), at[k][2]) + half);
    widest = fx_max(widest, fx_saturate((int64_t)b->high[k] - b->low[k]));
  }
  b->own = bits_of_own(w, t);
  return widest;
}

static uint32_t cell_count(const fray_world *w) {
  uint32_t cells = 1;
  while (cells < (uint32_t)w->sheet.state->triangles) cells += cells;
  return cells;
}

static uint32_t cell_at(const uint32_t at[3], uint32_t cells) {
  const uint32_t mixed = fx_wrap_mul_u(at[0], 73856093u) ^ fx_wrap_mul_u(at[1], 19349663u) ^
                         fx_wrap_mul_u(at[2], 83492791u);
  return (mixed ^ mixed >> 15) & (cells - 1u);
}

static int overlap(const layer_box *a, const layer_box *b) {
  return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] &&
         b->low[1] <= a->high[1] && a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
}

/* ---- pairs ---- */

static int is_same_place(const sheet_mesh *s, uint32_t p, uint32_t q) { return s->u[p] == s->u[q] && s->v[p] == s->v[q]; }

/* First of the two that is a vertex of the second: 1 where they have one in common; 2 where a tear has made two
 * of it. */
static int relation(const sheet_mesh *s, const row_id *a, uint32_t as, const row_id *b, uint32_t bs) {
  int found = 0;
  for (uint32_t m = 0; m < as; ++m)
    for (uint32_t n = 0; n < bs; ++n) {
      if (a[m] == b[n]) return 1;
      if (is_same_place(s, a[m], b[n])) found = 2;
    }
  return found;
}

static int are_near(const fray_world *w, const row_id *a, uint32_t as, const row_id *b, uint32_t bs, int32_t reach) {
  extent of[2] = {nothing, nothing};
  const vec3 zero = {0, 0, 0};
  for (uint32_t n = 0; n < as; ++n) extend(&of[0], zero, w->ways[a[n]].begin);
  for (uint32_t n = 0; n < bs; ++n) extend(&of[1], zero, w->ways[b[n]].begin);
  for (uint32_t k = 0; k < 3; ++k)
    if ((int64_t)of[1].low[k] - of[0].high[k] > reach || (int64_t)of[0].low[k] - of[1].high[k] > reach) return 0;
  return 1;
}

static int32_t until_of(const fray_world *w, int32_t apart) {
  const int64_t left = (int64_t)apart - least_apart(w);
  return left < 0 ? -1 : fx_saturate(w->listed.path + 2 * left / PER_STEP);
}

static int is_close(const fray_world *w, uint32_t p, uint32_t q) {
  const vec3 way = vec_sub(w->ways[p].begin, w->ways[q].begin);
  const uint32_t most = (uint32_t)w->selves->thickness;
  return is_same_place(&w->sheet, p, q) && fx_magnitude(way.x) <= most && fx_magnitude(way.y) <= most &&
         fx_magnitude(way.z) <= most;
}
/* What a tear has made two of is no farther apart than the thickness. */
static int are_one(const fray_world *w, const layer_pair *pair) {
  const uint32_t as = pair->sides != 0 ? 2u : 1u;
  for (uint32_t m = 0; m < as && pair->kin != 0; ++m)
    for (uint32_t n = as; n < 4; ++n)
      if (is_close(w, pair->p[m], pair->p[n])) return 1;
  return 0;
}

static void add_pair(fray_world *w, layer_pair *pair) {
  layer_list *l = &w->listed;
  const int32_t apart = layers_apart(w, pair);
  if (apart > l->reach) return;
  if (l->full != 0) {
    if (!are_one(w, pair)) layers_join(w, pair);
  } else if (l->pairs < w->capacity[POOL_LAYERS]) {
    pair->until = until_of(w, apart);
    w->layers[l->pairs++] = *pair;
  } else {
    l->lacks = 1;
  }
}

static void consider(fray_world *w, const row_id *first, const row_id *second, uint32_t sides, uint32_t key) {
  const uint32_t as = sides != 0 ? 2u : 1u;
  const uint32_t bs = sides != 0 ? 2u : 3u;
  const int related = relation(&w->sheet, first, as, second, bs);
  layer_pair pair = {{0, 0, 0, 0}, key, 0, (uint8_t)sides, related == 2, 0, 0};
  if (related == 1 || w->listed.lacks != 0 || !are_near(w, first, as, second, bs, w->listed.reach)) return;
  for (uint32_t n = 0; n < as; ++n) pair.p[n] = first[n];
  for (uint32_t n = 0; n < bs; ++n) pair.p[as + n] = second[n];
  add_pair(w, &pair);
}

/* Two triangles: whose vertices and sides they are to look at. */
static void meet(fray_world *w, uint32_t t, uint32_t other) {
  const row_id *a = w->sheet.triangle[t].v;
  const row_id *b = w->sheet.triangle[other].v;
  const uint32_t own_a = w->layer_boxes[t].own;
  const uint32_t own_b = w->layer_boxes[other].own;
  const uint32_t key = other << 4;
  for (uint32_t k = 0; k < 3; ++k) {
    if ((own_a >> k & 1u) != 0) consider(w, &a[k], b, 0, key + k);
    if ((own_b >> k & 1u) != 0) consider(w, &b[k], a, 0, key + 3u + k);
  }
  for (uint32_t m = 0; m < 3; ++m) {
    const row_id one[2] = {a[sheet_next(m)], a[sheet_last(m)]};
    for (uint32_t n = 0; n < 3; ++n) {
      const row_id two[2] = {b[sheet_next(n)], b[sheet_last(n)]};
      if ((own_a >> (3u + m) & own_b >> (3u + n) & 1u) != 0)
        consider(w, one, two, 1, key + LAYERS_KINDS + 3u * m + n);
    }
  }
}

static void sink(layer_pair *list, uint32_t at, uint32_t count) {
  const layer_pair pair = list[at];
  uint32_t place = at;
  for (;;) {
    uint32_t child = 2u * place + 1u;
    if (child >= count) break;
    if (child + 1u < count && list[child + 1u].key > list[child].key) ++child;
    if (list[child].key <= pair.key) break;
    list[place] = list[child];
    place = child;
  }
  list[place] = pair;
}

static void put_in_order(layer_pair *list, uint32_t count) {
  if (count <= SHORT) {
    for (uint32_t n = 1; n < count; ++n) {
      const layer_pair pair = list[n];
      uint32_t at = n;
      for (; at > 0 && list[at - 1u].key > pair.key; --at) list[at] = list[at - 1u];
      list[at] = pair;
    }
    return;
  }
  for (uint32_t n = count / 2u; n > 0; --n) sink(list, n - 1u, count);
  for (uint32_t n = count - 1u; n > 0; --n) {
    const layer_pair last = list[n];
    list[n] = list[0];
    list[0] = last;
    sink(list, 0, n);
  }
}

/* Those of a cell. */
static void look_into(fray_world *w, uint32_t t, const uint32_t at[3], uint32_t cells) {
  const layer_box *b = &w->layer_boxes[t];
  row_id other = w->layer_cells[cell_at(at, cells)];
  for (; other != LAYERS_NOBODY; other = w->layer_next[other]) {
    const layer_box *o = &w->layer_boxes[other];
    if (o->cell[0] != at[0] || o->cell[1] != at[1] || o->cell[2] != at[2]) continue;
    ++w->work.self_visits;
    if (overlap(b, o)) meet(w, t, other);
  }
}

/* All pairs of a triangle with those before it, in order. */
static void list_triangle(fray_world *w, uint32_t t, uint32_t cells) {
  const layer_box *b = &w->layer_boxes[t];
  const uint32_t first = w->listed.pairs;
  uint32_t at[3];
  for (at[0] = b->cell[0] - 1u; at[0] <= b->cell[0] + 1u; ++at[0])
    for (at[1] = b->cell[1] - 1u; at[1] <= b->cell[1] + 1u; ++at[1])
      for (at[2] = b->cell[2] - 1u; at[2] <= b->cell[2] + 1u; ++at[2]) look_into(w, t, at, cells);
  if (w->listed.lacks == 0)
    put_in_order(w->layers + first, w->listed.pairs - first);
  else
    w->listed.pairs = first;
}

/* Returns how many cells there are. */
static uint32_t box_all(fray_world *w) {
  const uint32_t triangles = (uint32_t)w->sheet.state->triangles;
  const uint32_t cells = cell_count(w);
  const int32_t half = w->listed.reach / 2 + 1;
  int32_t widest = 1;
  for (uint32_t t = 0; t < triangles; ++t) widest = fx_max(widest, box_of(w, t, half));
  for (uint32_t t = 0; t < triangles; ++t) {
    layer_box *b = &w->layer_boxes[t];
    for (uint32_t k = 0; k < 3; ++k)
      b->cell[k] = 1u + (uint32_t)(((int64_t)b->low[k] + ((int64_t)FAR << FX_POSITION_BITS)) / widest);
  }
  for (uint32_t n = 0; n < cells; ++n) w->layer_cells[n] = LAYERS_NOBODY;
  return cells;
}

/* Triangle after triangle, and each has its place in a cell when it has been looked at. Where there is no room
 * for all, `joins`: what there is none for is joined, from the first triangle on of which something is; else
 * nothing is listed, and 0 returned. */
static int list_all(fray_world *w, int64_t reach, int joins) {
  layer_list *l = &w->listed;
  const uint32_t triangles = (uint32_t)w->sheet.state->triangles;
  l->reach = (int32_t)fx_clamp64(reach, 0, FX_WORLD_MAX);
  l->path = 0;
  l->pairs = l->kept = l->lacks = l->full = 0;
  const uint32_t cells = box_all(w);
  for (uint32_t t = 0; t < triangles; ++t) {
    list_triangle(w, t, cells);
    if (l->lacks != 0) {
      if (!joins) return 0;
      l->lacks = 0;
      l->full = 1;
      list_triangle(w, t, cells);
    }
    const uint32_t cell = cell_at(w->layer_boxes[t].cell, cells);
    w->layer_next[t] = w->layer_cells[cell];
    w->layer_cells[cell] = (row_id)t;
  }
  return l->full == 0;
}

static void keep(fray_world *w) {
  for (uint32_t p = 0; p < w->particles; ++p) w->layers_from[p] = w->ways[p].begin;
  w->listed.particles = w->particles;
  w->listed.topology[0] = w->state->topology[0];
  w->listed.topology[1] = w->state->topology[1];
  w->listed.kept = 1;
}

static void make_list(fray_world *w) {
  const int64_t roomy = least_apart(w) + ROOM * (int64_t)w->sheet.params->height_min;
  const int64_t fast = least_reach(w, w->listed.spread);
  if (list_all(w, roomy > fast ? roomy : fast, 0) || list_all(w, least_reach(w, 0), 1))
    keep(w);
  else
    w->state->faults |= (int32_t)FRAY_FAULT_SELVES;
}

static void find_met(fray_world *w) {
  layer_list *l = &w->listed;
  const int32_t now = fx_saturate((int64_t)l->path + 2 * (int64_t)l->spread);
  l->met = 0;
  for (uint32_t n = 0; n < l->pairs; ++n) {
    layer_pair *pair = &w->layers[n];
    if (pair->until > now) continue;
    pair->until = until_of(w, layers_apart(w, pair));
    if (pair->until > now || are_one(w, pair)) continue;
    pair->looked = pair->near = 0;
    w->layers_met[l->met++] = n;
  }
  w->work.self_pairs += l->met;
}

void layers_find(fray_world *w) {
  w->listed.spread = spread_of_ways(w);
  if (w->listed.kept == 0 || least_reach(w, spread_since(w)) > w->listed.reach) make_list(w);
  find_met(w);
}
