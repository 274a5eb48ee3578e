/* SPDX-License-Identifier: Apache-2.0 */
/* Which vertices and triangles, and which sides, may meet in a tick.
 *
 * A list of all that is near each other is kept from tick to tick, with more in it than a tick needs. Triangles
 * that are near each other at rest are a tile. Each triangle has room to go beside its tile, and each two tiles
 * beside each other; when that is used up that triangle alone, or those two tiles, are looked at again, as are
 * triangles that a tear or cut has changed. Each pair says how far its two may go, together, until they can meet,
 * by what separated them when they were looked at last. Ways are those of corners, by the longest, less the mean
 * of the tile: what a part of the sheet moves by brings nothing in it nearer.
 *
 * What may meet in this tick is those that are no farther apart than the thickness and what they go beside each
 * other, and that the direction in which they are nearest when it begins does not separate when it ends. That follows
 * from the state and the ways of the tick alone. So the list is no state: one that has more, or was made at another
 * time, gives the same result to the last bit. In a world just opened there is none. */
#include "rt/stage/layers_tiles.h"

#include "rt/stage/layers.h"

enum { SHORT = 24 }; /* segments of the list that are put in order one by one */

/* How far corners of the second go beside those of the first in this tick, at most. */
static int64_t gone_beside(const fray_world *w, const layer_pair *pair) {
  const uint32_t as = layer_firsts(pair);
  int32_t most = 0;
  for (uint32_t m = 0; m < as; ++m)
    for (uint32_t n = as; n < 4; ++n) {
      const self_way *a = &w->ways[pair->p[m]];
      const self_way *b = &w->ways[pair->p[n]];
      most = fx_max(most, tiles_gone_by(b->begin, b->end, vec_sub(a->end, a->begin)));
    }
  return most;
}

static int may_meet(const fray_world *w, const layer_pair *pair, sweep_gap gap) {
  const int64_t least = least_apart(w);
  return (gap.begin <= least || gap.end <= least) && gap.begin <= least + gone_beside(w, pair);
}

/* ---- pairs ---- */

static int is_same_place(const sheet_mesh *s, uint32_t p, uint32_t q) { return s->u[p] == s->u[q] && s->v[p] == s->v[q]; }

static int is_close(const fray_world *w, uint32_t p, uint32_t q) {
  const vec3 way = vec_sub(w->ways[p].begin, w->ways[q].begin);
  const uint32_t most = (uint32_t)w->selves->thickness;
  return is_same_place(&w->sheet, p, q) && fx_magnitude(way.x) <= most && fx_magnitude(way.y) <= most &&
         fx_magnitude(way.z) <= most;
}
/* What a tear has made two of is no farther apart than the thickness. */
static int are_one(const fray_world *w, const layer_pair *pair) {
  const uint32_t as = layer_firsts(pair);
  for (uint32_t m = 0; m < as && pair->kin != 0; ++m)
    for (uint32_t n = as; n < 4; ++n)
      if (is_close(w, pair->p[m], pair->p[n])) return 1;
  return 0;
}

static uint8_t has_kin(const sheet_mesh *s, const layer_pair *pair) {
  const uint32_t as = layer_firsts(pair);
  for (uint32_t m = 0; m < as; ++m)
    for (uint32_t n = as; n < 4; ++n)
      if (is_same_place(s, pair->p[m], pair->p[n])) return 1;
  return 0;
}

static int32_t mid(int32_t c, int32_t d, int32_t a, int32_t b) {
  return fx_asr(c, 6) + fx_asr(d, 6) - fx_asr(a, 6) - fx_asr(b, 6);
}
static int32_t third(int32_t b, int32_t c, int32_t d, int32_t a) {
  return fx_asr(b, 5) + fx_asr(c, 5) + fx_asr(d, 5) - 3 * fx_asr(a, 5);
}

/* The way between the middles separates them by more than the reach: when the tick begins, or until it ends. */
static int are_separated(const fray_world *w, const layer_pair *pair, int64_t reach, int all) {
  const uint32_t as = layer_firsts(pair);
  const self_way *way[4];
  for (uint32_t n = 0; n < 4; ++n) way[n] = &w->ways[pair->p[n]];
  const vec3 p = way[0]->begin;
  const vec3 q = way[1]->begin;
  const vec3 r = way[2]->begin;
  const vec3 s = way[3]->begin;
  /* in 29 bits */
  const vec3 along = as == 2 ? vec_make(mid(r.x, s.x, p.x, q.x), mid(r.y, s.y, p.y, q.y), mid(r.z, s.z, p.z, q.z))
                             : vec_make(third(q.x, r.x, s.x, p.x), third(q.y, r.y, s.y, p.y), third(q.z, r.z, s.z, p.z));
  const int64_t least = fx_mul_wide(zones_length(along), fx_saturate(reach));
  int64_t most[2] = {least, least};
  if (as == 2) {
    const int64_t begin = zones_along(p, q, along);
    const int64_t end = zones_along(way[0]->end, way[1]->end, along);
    if (begin > 0) most[0] = fx_add64(most[0], begin);
    if (end > 0) most[1] = fx_add64(most[1], end);
  }
  for (uint32_t n = as; n < 4; ++n)
    if (zones_along(p, way[n]->begin, along) <= most[0] || (all && zones_along(way[0]->end, way[n]->end, along) <= most[1]))
      return 0;
  return 1;
}

/* How far both are from where they were listed, with their tiles; and with this tick. */
static int64_t gone_together(const fray_world *w, const layer_pair *pair) {
  const uint32_t a = w->layer_boxes[pair->of[0]].tile;
  const uint32_t b = w->layer_boxes[pair->of[1]].tile;
  return (int64_t)w->layer_ways[pair->of[0]].gone + w->layer_ways[pair->of[1]].gone +
         (a == b ? 0 : between(w, a, b)->gone);
}
static int64_t soon_of(const fray_world *w, const layer_pair *pair) {
  const uint32_t a = w->layer_boxes[pair->of[0]].tile;
  const uint32_t b = w->layer_boxes[pair->of[1]].tile;
  return (int64_t)w->layer_soon[pair->of[0]] + w->layer_soon[pair->of[1]] + (a == b ? 0 : between(w, a, b)->soon);
}

/* Of a pair that stands in the list. */
static void look_at(fray_world *w, uint32_t n, sweep_gap gap) {
  layer_pair *pair = &w->layers[n];
  const int64_t left = (int64_t)gap.begin - least_apart(w) - gone_together(w, pair);
  pair->until = fx_saturate(left);
  if (!may_meet(w, pair, gap) || are_separated(w, pair, least_apart(w), 1) || are_one(w, pair)) return;
  pair->looked = pair->near = 0;
  w->layers_met[w->listed->met++] = n;
}

static void add_pair(fray_world *w, layer_pair *pair, int64_t reach) {
  layer_list *l = w->listed;
  if (are_separated(w, pair, reach, 0)) return;
  const int now = l->tight != 0 || w->layer_boxes[pair->of[0]].hot != 0 || w->layer_boxes[pair->of[1]].hot != 0;
  if (now && are_separated(w, pair, least_apart(w), 1)) return;
  const sweep_gap gap = layers_gap(w, pair);
  if (gap.begin > reach || (now && !may_meet(w, pair, gap))) return;
  pair->kin = has_kin(&w->sheet, pair);
  if (l->full != 0) {
    if (!are_one(w, pair)) layers_join(w, pair);
  } else if (l->pairs < w->capacity[POOL_LAYERS]) {
    w->layers[l->pairs++] = *pair;
    look_at(w, l->pairs - 1u, gap);
  } else {
    l->lacks = 1;
  }
}

/* Two triangles as they are held against each other. */
typedef struct {
  const row_id *v[2];
  vec3 at[2][3];
  uint32_t common[3]; /* of each corner of the first: the second's that is the same vertex, a bit each */
  uint32_t of[2];
  int32_t reach;
} duo;

static int is_beside(int32_t a0, int32_t a1, int32_t b0, int32_t b1, int32_t reach) {
  return fx_sub(fx_min(b0, b1), fx_max(a0, a1)) > reach || fx_sub(fx_min(a0, a1), fx_max(b0, b1)) > reach;
}
static int sides_are_beside(const duo *d, uint32_t m, uint32_t n) {
  const vec3 *p = &d->at[0][sheet_next(m)];
  const vec3 *q = &d->at[0][sheet_last(m)];
  const vec3 *r = &d->at[1][sheet_next(n)];
  const vec3 *s = &d->at[1][sheet_last(n)];
  return is_beside(p->x, q->x, r->x, s->x, d->reach) || is_beside(p->y, q->y, r->y, s->y, d->reach) ||
         is_beside(p->z, q->z, r->z, s->z, d->reach);
}
static int is_off(int32_t p, const int32_t a, const int32_t b, const int32_t c, int32_t reach) {
  return fx_sub(fx_min(fx_min(a, b), c), p) > reach || fx_sub(p, fx_max(fx_max(a, b), c)) > reach;
}
static int corner_is_off(const duo *d, uint32_t of, uint32_t k) {
  const vec3 p = d->at[of][k];
  const vec3 *t = d->at[1u - of];
  return is_off(p.x, t[0].x, t[1].x, t[2].x, d->reach) || is_off(p.y, t[0].y, t[1].y, t[2].y, d->reach) ||
         is_off(p.z, t[0].z, t[1].z, t[2].z, d->reach);
}

static int32_t way_between(int32_t a, int32_t b, int32_t c, int32_t d, int32_t e, int32_t f) {
  return fx_asr(d, 5) + fx_asr(e, 5) + fx_asr(f, 5) - fx_asr(a, 5) - fx_asr(b, 5) - fx_asr(c, 5);
}
/* The second's corners are beyond the first's along the way between their middles, farther than anything that is
 * listed: so are all their parts. */
static int are_parted(const duo *d) {
  const vec3 *a = d->at[0];
  const vec3 *b = d->at[1];
  const vec3 way = vec_make(way_between(a[0].x, a[1].x, a[2].x, b[0].x, b[1].x, b[2].x),
                            way_between(a[0].y, a[1].y, a[2].y, b[0].y, b[1].y, b[2].y),
                            way_between(a[0].z, a[1].z, a[2].z, b[0].z, b[1].z, b[2].z));
  int64_t most = 0;
  for (uint32_t n = 1; n < 3; ++n) {
    const int64_t at = zones_along(a[0], a[n], way);
    if (at > most) most = at;
  }
  most += fx_mul_wide(zones_length(way), d->reach);
  return zones_along(a[0], b[0], way) > most && zones_along(a[0], b[1], way) > most && zones_along(a[0], b[2], way) > most;
}

static void add_corner(fray_world *w, const duo *d, uint32_t of, uint32_t k) {
  const row_id *v = d->v[1u - of];
  layer_pair pair = {0, {(row_id)d->of[0], (row_id)d->of[1]}, {d->v[of][k], v[0], v[1], v[2]}, (uint8_t)(3u * of + k), 0, 0, 0};
  add_pair(w, &pair, d->reach);
}
static void add_sides(fray_world *w, const duo *d, uint32_t m, uint32_t n) {
  layer_pair pair = {0, {(row_id)d->of[0], (row_id)d->of[1]},
                     {d->v[0][sheet_next(m)], d->v[0][sheet_last(m)], d->v[1][sheet_next(n)], d->v[1][sheet_last(n)]},
                     (uint8_t)(LAYERS_CORNERS + 3u * m + n), 0, 0, 0};
  add_pair(w, &pair, d->reach);
}

/* Returns which corners of the second are the first's. */
static uint32_t begin_duo(const fray_world *w, uint32_t t, uint32_t other, duo *d) {
  uint32_t common = 0;
  d->of[0] = t > other ? t : other;
  d->of[1] = t > other ? other : t;
  for (uint32_t n = 0; n < 2; ++n) {
    d->v[n] = w->sheet.triangle[d->of[n]].v;
    for (uint32_t k = 0; k < 3; ++k) d->at[n][k] = w->ways[d->v[n][k]].begin;
  }
  for (uint32_t k = 0; k < 3; ++k) {
    const row_id p = d->v[0][k];
    d->common[k] = (p == d->v[1][0] ? 1u : 0u) | (p == d->v[1][1] ? 2u : 0u) | (p == d->v[1][2] ? 4u : 0u);
    common |= d->common[k];
  }
  return common;
}

/* Whose vertices and sides they are to look at. What has a vertex in common does not meet. */
static void meet(fray_world *w, uint32_t t, uint32_t other, int32_t reach) {
  duo d;
  d.reach = reach;
  const uint32_t common = begin_duo(w, t, other, &d);
  const uint32_t own[2] = {w->layer_boxes[d.of[0]].own, w->layer_boxes[d.of[1]].own};
  if (common == 0 && are_parted(&d)) return;
  for (uint32_t k = 0; k < 3; ++k) {
    if ((own[0] >> k & 1u) != 0 && d.common[k] == 0 && !corner_is_off(&d, 0, k)) add_corner(w, &d, 0, k);
    if ((own[1] >> k & 1u) != 0 && (common >> k & 1u) == 0 && !corner_is_off(&d, 1, k)) add_corner(w, &d, 1, k);
  }
  for (uint32_t m = 0; m < 3; ++m) {
    const uint32_t has = d.common[sheet_next(m)] | d.common[sheet_last(m)];
    if ((own[0] >> (3u + m) & 1u) == 0) continue;
    for (uint32_t n = 0; n < 3; ++n)
      if ((own[1] >> (3u + n) & 1u) != 0 && (has & ~(1u << n)) == 0 && !sides_are_beside(&d, m, n)) add_sides(w, &d, m, n);
  }
}

/* ---- looking for them ---- */

static void try_two(fray_world *w, const layer_box *box, uint32_t t, uint32_t other, int64_t room) {
  const layer_box *b = &w->layer_boxes[other];
  ++w->work.self_visits;
  if (overlap(box->low, box->high, b->low, b->high))
    meet(w, t, other, fx_saturate(least_apart(w) + room + room_of(w, t) + room_of(w, other)));
}

static void list_clump(fray_world *w, const layer_box *box, uint32_t t, uint32_t first, uint32_t end, int64_t room, int all) {
  for (uint32_t n = first; n < end; ++n) {
    const uint32_t other = w->layer_order[n];
    if (all || other < t || (other > t && w->layer_soon[other] != LAYERS_STALE)) try_two(w, box, t, other, room);
  }
}

/* A triangle with those of a tile; of two that are both stale the one with the greater number does it. */
static void list_with(fray_world *w, uint32_t t, uint32_t tile, int all) {
  const layer_tile *of = &w->tiles[tile];
  layer_box box = w->layer_boxes[t];
  const int64_t room = room_between(w, box.tile, tile);
  widen_by(box.low, box.high, room);
  if (!overlap(box.low, box.high, of->low, of->high)) return;
  for (uint32_t n = of->first; n < of->end && w->listed->lacks == 0; n += LAYERS_CLUMP) {
    const layer_clump *clump = &w->layer_clumps[n];
    ++w->work.self_visits;
    if (overlap(box.low, box.high, clump->low, clump->high))
      list_clump(w, &box, t, n, n + LAYERS_CLUMP < of->end ? n + LAYERS_CLUMP : of->end, room, all);
  }
}

/* With those of all tiles that are listed together. */
static void list_near(fray_world *w, uint32_t t, uint64_t tiles) {
  for (uint64_t left = tiles; left != 0 && w->listed->lacks == 0; left &= left - 1u)
    list_with(w, t, 63u - fx_leading_zeros64(left & (~left + 1u)), 0);
}

static void list_tiles(fray_world *w, uint32_t a, uint32_t b) {
  const layer_tile *of = &w->tiles[a];
  for (uint32_t n = of->first; n < of->end && w->listed->lacks == 0; ++n) list_with(w, w->layer_order[n], b, 1);
}

/* What was listed: without what is stale, and what may meet. */
static void look_at_list(fray_world *w) {
  layer_list *l = w->listed;
  uint32_t kept = 0;
  for (uint32_t n = 0; n < l->pairs; ++n) {
    const layer_pair *pair = &w->layers[n];
    const int64_t soon = soon_of(w, pair);
    if (soon >= LAYERS_STALE) continue; /* of what is not stale it is less */
    if (kept != n) w->layers[kept] = *pair;
    ++kept;
    if (soon >= w->layers[kept - 1u].until) look_at(w, kept - 1u, layers_gap(w, &w->layers[kept - 1u]));
  }
  l->pairs = kept;
}

/* Returns 0 where there is no room. */
static int list_stale(fray_world *w) {
  layer_list *l = w->listed;
  l->full = l->lacks = 0;
  for (uint32_t n = 0; n < l->stale && l->lacks == 0; ++n) {
    const uint32_t t = w->layer_stale[n];
    list_near(w, t, w->tiles[w->layer_boxes[t].tile].near);
  }
  for (uint32_t a = 0; a < tiles_of(w); ++a)
    for (uint32_t b = 0; b < a && l->lacks == 0; ++b)
      if (between(w, a, b)->room >= 0 && between(w, a, b)->soon == LAYERS_STALE) list_tiles(w, a, b);
  return l->lacks == 0;
}

/* Only what may meet in this tick, triangle after triangle. What there is no room for is joined, from the first
 * triangle on of which there is something. */
static void list_tight(fray_world *w) {
  layer_list *l = w->listed;
  tiles_begin(w);
  l->kept = l->full = l->lacks = l->met = 0;
  l->tight = 1;
  tiles_find_stale(w);
  tiles_find_beside(w);
  for (uint32_t t = 0; t < triangles_of(w); ++t) {
    const uint32_t first = l->pairs;
    const uint32_t met = l->met;
    uint64_t near = 0;
    for (uint32_t b = 0; b < tiles_of(w); ++b)
      if (b == w->layer_boxes[t].tile || between(w, w->layer_boxes[t].tile, b)->room >= 0) near |= (uint64_t)1 << b;
    for (uint32_t again = 0; again < 2; ++again) {
      list_near(w, t, near);
      if (l->lacks == 0) break;
      l->lacks = 0;
      l->full = 1;
      l->pairs = first;
      l->met = met;
      w->state->faults |= (int32_t)FRAY_FAULT_SELVES;
    }
  }
  l->tight = 0;
}

/* ---- in order ---- */

static uint64_t rank_of(const fray_world *w, uint32_t n) {
  const layer_pair *pair = &w->layers[n];
  return (uint64_t)pair->of[1] << 8 | pair->kind;
}

static void sink(const fray_world *w, uint32_t *list, uint32_t at, uint32_t count) {
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

/* What one triangle has, by the other one and the kind. */
static void put_in_order(const fray_world *w, uint32_t *list, uint32_t count) {
  if (count <= SHORT) {
    for (uint32_t n = 1; n < count; ++n) {
      const uint32_t pair = list[n];
      uint32_t at = n;
      for (; at > 0 && rank_of(w, list[at - 1u]) > rank_of(w, pair); --at) list[at] = list[at - 1u];
      list[at] = pair;
    }
    return;
  }
  for (uint32_t n = count / 2u; n > 0; --n) sink(w, list, n - 1u, count);
  for (uint32_t n = count - 1u; n > 0; --n) {
    const uint32_t last = list[n];
    list[n] = list[0];
    list[0] = last;
    sink(w, list, 0, n);
  }
}

static void order_met(fray_world *w) {
  const uint32_t triangles = triangles_of(w);
  const uint32_t met = w->listed->met;
  uint32_t *counts = w->layer_counts;
  uint32_t *from = w->layers_met + w->capacity[POOL_LAYERS];
  uint32_t sum = 0;
  if (met == 0) return;
  for (uint32_t t = 0; t < triangles; ++t) counts[t] = 0;
  for (uint32_t n = 0; n < met; ++n) {
    from[n] = w->layers_met[n];
    ++counts[w->layers[from[n]].of[0]];
  }
  for (uint32_t t = 0; t < triangles; ++t) {
    sum += counts[t];
    counts[t] = sum - counts[t];
  }
  for (uint32_t n = 0; n < met; ++n) w->layers_met[counts[w->layers[from[n]].of[0]]++] = from[n];
  uint32_t first = 0;
  for (uint32_t t = 0; t < triangles; ++t) {
    put_in_order(w, w->layers_met + first, counts[t] - first);
    first = counts[t];
  }
}

int layers_find(fray_world *w) {
  layer_list *l = w->listed;
  l->tight = l->met = l->wild = 0;
  if (l->kept == 0)
    tiles_begin(w);
  else
    tiles_follow(w);
  tiles_find_stale(w);
  tiles_find_beside(w);
  if (l->wild != 0) {
    l->kept = 0;
    return 0;
  }
  look_at_list(w);
  if (!list_stale(w)) list_tight(w);
  order_met(w);
  w->work.self_pairs += l->met;
  return 1;
}
