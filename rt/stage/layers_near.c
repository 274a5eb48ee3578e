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
  MARGIN_BITS = 4, /* what sweeps may be wrong by: that share of the least height that cuts leave */
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

static int has_kin(const sheet_mesh *s, const layer_pair *pair) {
  const uint32_t as = pair->sides != 0 ? 2u : 1u;
  for (uint32_t m = 0; m < as; ++m)
    for (uint32_t n = as; n < 4; ++n)
      if (is_same_place(s, pair->p[m], pair->p[n])) return 1;
  return 0;
}

/* How far corners of the second go beside those of the first in this tick, at most. */
static int64_t gone_beside(const fray_world *w, const layer_pair *pair) {
  const uint32_t as = pair->sides != 0 ? 2u : 1u;
  vec3 moved[4];
  int32_t most = 0;
  for (uint32_t n = 0; n < 4; ++n) {
    const self_way *way = &w->ways[pair->p[n]];
    moved[n] = vec_sub(way->end, way->begin);
  }
  for (uint32_t m = 0; m < as; ++m)
    for (uint32_t n = as; n < 4; ++n) {
      const vec3 beside = vec_sub(moved[n], moved[m]);
      const uint32_t wide = fx_magnitude(beside.x) | fx_magnitude(beside.y) | fx_magnitude(beside.z);
      most = fx_max(most, wide >= 1u << 29 ? INT32_MAX : zones_length(beside));
    }
  return most;
}

/* What is farther apart in the beginning does not meet in this tick. */
static int64_t reach_of(const fray_world *w, const layer_pair *pair) {
  return least_apart(w) + 2 * gone_beside(w, pair);
}

static void add_pair(fray_world *w, layer_pair *pair) {
  layer_list *l = &w->listed;
  const int32_t apart = layers_apart(w, pair);
  if (apart > l->reach || (l->tight != 0 && apart > reach_of(w, pair))) return;
  pair->kin = (uint8_t)has_kin(&w->sheet, pair);
  if (l->full != 0) {
    if (!are_one(w, pair)) layers_join(w, pair);
  } else if (l->pairs < w->capacity[POOL_LAYERS]) {
    pair->until = until_of(w, apart);
    w->layers[l->pairs++] = *pair;
  } else {
    l->lacks = 1;
  }
}

/* Two triangles as they are held against each other. */
typedef struct {
  const row_id *a, *b;
  vec3 at[2][3];
  uint32_t common[3]; /* of each corner of the first: the second's that is the same vertex, a bit each */
  uint32_t key;
} duo;

static int is_beside(int32_t a0, int32_t a1, int32_t b0, int32_t b1, int32_t reach) {
  return (int64_t)fx_min(b0, b1) - fx_max(a0, a1) > reach || (int64_t)fx_min(a0, a1) - fx_max(b0, b1) > reach;
}
static int sides_are_beside(const vec3 a[3], uint32_t m, const vec3 b[3], uint32_t n, int32_t reach) {
  const vec3 *p = &a[sheet_next(m)];
  const vec3 *q = &a[sheet_last(m)];
  const vec3 *r = &b[sheet_next(n)];
  const vec3 *s = &b[sheet_last(n)];
  return is_beside(p->x, q->x, r->x, s->x, reach) || is_beside(p->y, q->y, r->y, s->y, reach) ||
         is_beside(p->z, q->z, r->z, s->z, reach);
}
static int is_off(const layer_box *box, vec3 p, int32_t more) {
  return p.x < box->low[0] - more || p.x > box->high[0] + more || p.y < box->low[1] - more || p.y > box->high[1] + more ||
         p.z < box->low[2] - more || p.z > box->high[2] + more;
}

/* The second's corners are beyond the first's along the way between their middles, farther than anything that is
 * listed: so are all their parts. */
static int are_parted(const duo *d, int32_t reach) {
  const vec3 *a = d->at[0];
  const vec3 *b = d->at[1];
  const vec3 way = vec_make(
      fx_asr(b[0].x, 5) + fx_asr(b[1].x, 5) + fx_asr(b[2].x, 5) - fx_asr(a[0].x, 5) - fx_asr(a[1].x, 5) - fx_asr(a[2].x, 5),
      fx_asr(b[0].y, 5) + fx_asr(b[1].y, 5) + fx_asr(b[2].y, 5) - fx_asr(a[0].y, 5) - fx_asr(a[1].y, 5) - fx_asr(a[2].y, 5),
      fx_asr(b[0].z, 5) + fx_asr(b[1].z, 5) + fx_asr(b[2].z, 5) - fx_asr(a[0].z, 5) - fx_asr(a[1].z, 5) - fx_asr(a[2].z, 5));
  int64_t most = 0;
  for (uint32_t n = 1; n < 3; ++n) {
    const int64_t at = zones_along(a[0], a[n], way);
    if (at > most) most = at;
  }
  most += fx_mul_wide(zones_length(way), reach);
  return zones_along(a[0], b[0], way) > most && zones_along(a[0], b[1], way) > most && zones_along(a[0], b[2], way) > most;
}

static void add_corner(fray_world *w, row_id p, const row_id v[3], uint32_t key) {
  layer_pair pair = {{p, v[0], v[1], v[2]}, key, 0, 0, 0, 0, 0};
  add_pair(w, &pair);
}
static void add_sides(fray_world *w, const duo *d, uint32_t m, uint32_t n) {
  layer_pair pair = {{d->a[sheet_next(m)], d->a[sheet_last(m)], d->b[sheet_next(n)], d->b[sheet_last(n)]},
                     d->key + LAYERS_KINDS + 3u * m + n, 0, 1, 0, 0, 0};
  add_pair(w, &pair);
}

static uint32_t begin_duo(const fray_world *w, uint32_t t, uint32_t other, duo *d) {
  uint32_t common = 0;
  d->a = w->sheet.triangle[t].v;
  d->b = w->sheet.triangle[other].v;
  d->key = other << 4;
  for (uint32_t k = 0; k < 3; ++k) {
    d->at[0][k] = w->ways[d->a[k]].begin;
    d->at[1][k] = w->ways[d->b[k]].begin;
    d->common[k] = (uint32_t)(d->a[k] == d->b[0]) | (uint32_t)(d->a[k] == d->b[1]) << 1 | (uint32_t)(d->a[k] == d->b[2]) << 2;
    common |= d->common[k];
  }
  return common;
}

/* Whose vertices and sides they are to look at. Those of one vertex do not meet. */
static void meet(fray_world *w, uint32_t t, uint32_t other) {
  const layer_box *one = &w->layer_boxes[t];
  const layer_box *two = &w->layer_boxes[other];
  const int32_t reach = w->listed.reach;
  const int32_t more = reach - reach / 2;
  duo d;
  const uint32_t common = begin_duo(w, t, other, &d);
  if (common == 0 && are_parted(&d, reach)) return;
  for (uint32_t k = 0; k < 3; ++k) {
    if ((one->own >> k & 1u) != 0 && d.common[k] == 0 && !is_off(two, d.at[0][k], more)) add_corner(w, d.a[k], d.b, d.key + k);
    if ((two->own >> k & 1u) != 0 && (common >> k & 1u) == 0 && !is_off(one, d.at[1][k], more))
      add_corner(w, d.b[k], d.a, d.key + 3u + k);
  }
  for (uint32_t m = 0; m < 3; ++m) {
    const uint32_t has = d.common[sheet_next(m)] | d.common[sheet_last(m)];
    if ((one->own >> (3u + m) & 1u) == 0) continue;
    for (uint32_t n = 0; n < 3; ++n)
      if ((two->own >> (3u + n) & 1u) != 0 && (has & ~(1u << n)) == 0 && !sides_are_beside(d.at[0], m, d.at[1], n, reach))
        add_sides(w, &d, m, n);
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
 * for all, 0 is returned; a tight list has only what may meet in this tick, and what it has no room for is joined,
 * from the first triangle on of which something is. */
static int list_all(fray_world *w, int64_t reach, uint32_t tight) {
  layer_list *l = &w->listed;
  const uint32_t triangles = (uint32_t)w->sheet.state->triangles;
  l->reach = (int32_t)fx_clamp64(reach, 0, FX_WORLD_MAX);
  l->path = 0;
  l->tight = tight;
  l->pairs = l->kept = l->lacks = l->full = 0;
  const uint32_t cells = box_all(w);
  for (uint32_t t = 0; t < triangles; ++t) {
    list_triangle(w, t, cells);
    if (l->lacks != 0) {
      if (tight == 0) return 0;
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
  if (list_all(w, roomy > fast ? roomy : fast, 0))
    keep(w);
  else if (!list_all(w, least_reach(w, 0), 1))
    w->state->faults |= (int32_t)FRAY_FAULT_SELVES;
}

static void find_met(fray_world *w) {
  layer_list *l = &w->listed;
  const int32_t now = fx_saturate((int64_t)l->path + 2 * (int64_t)l->spread);
  l->met = 0;
  for (uint32_t n = 0; n < l->pairs; ++n) {
    layer_pair *pair = &w->layers[n];
    if (pair->until > now) continue;
    const int32_t apart = layers_apart(w, pair);
    pair->until = until_of(w, apart);
    if (pair->until > now || apart > reach_of(w, pair) || are_one(w, pair)) continue;
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
