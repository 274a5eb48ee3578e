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
#include "rt/stage/layers.h"

enum {
  SHORT = 24,      /* segments of the list that are put in order one by one */
  FAST = 1,        /* what goes farther in a tick than that part of its room is looked at in every one */
  USUAL = 8,       /* room: that part of how wide triangles are */
  PATH_MOST = 1 << 28,
  TOO_FAR = 1 << 29 /* in a tick, or from where it was: nobody knows whom it meets */
};

/* ---- ways ---- */

static uint32_t triangles_of(const fray_world *w) { return (uint32_t)w->sheet.state->triangles; }

static int32_t gone_by(vec3 from, vec3 to, vec3 mean) {
  const int64_t way[3] = {(int64_t)to.x - from.x - mean.x, (int64_t)to.y - from.y - mean.y, (int64_t)to.z - from.z - mean.z};
  const int64_t most = PATH_MOST / 2;
  for (uint32_t k = 0; k < 3; ++k)
    if (way[k] > most || way[k] < -most) return TOO_FAR;
  return zones_length(vec_make((int32_t)way[0], (int32_t)way[1], (int32_t)way[2]));
}

static vec3 mean_of(const fray_world *w, const layer_tile *tile) {
  int64_t sum[3] = {0, 0, 0};
  const int64_t count = 3 * ((int64_t)tile->end - tile->first);
  for (uint32_t n = tile->first; n < tile->end; ++n)
    for (uint32_t k = 0; k < 3; ++k) {
      const self_way *way = &w->ways[w->layer_boxes[w->layer_order[n]].v[k]];
      sum[0] += (int64_t)way->end.x - way->begin.x;
      sum[1] += (int64_t)way->end.y - way->begin.y;
      sum[2] += (int64_t)way->end.z - way->begin.z;
    }
  if (count == 0) return vec_make(0, 0, 0);
  return vec_make((int32_t)(sum[0] / count), (int32_t)(sum[1] / count), (int32_t)(sum[2] / count));
}

/* As it would be if its tile had not gone anywhere. Wraps: only differences are used. */
static vec3 wrap_sub(vec3 a, vec3 b) {
  return vec_make(fx_wrap_sub(a.x, b.x), fx_wrap_sub(a.y, b.y), fx_wrap_sub(a.z, b.z));
}
static int32_t length_most(vec3 v) {
  const uint32_t most = PATH_MOST / 2;
  if (fx_magnitude(v.x) > most || fx_magnitude(v.y) > most || fx_magnitude(v.z) > most) return TOO_FAR;
  return zones_length(v);
}

/* In this tick. */
static int32_t goes_by(const fray_world *w, uint32_t t) {
  const layer_box *b = &w->layer_boxes[t];
  const vec3 mean = w->tiles[b->tile].mean;
  int32_t most = 0;
  for (uint32_t k = 0; k < 3; ++k) most = fx_max(most, gone_by(w->ways[b->v[k]].begin, w->ways[b->v[k]].end, mean));
  return most;
}

static vec3 place_of(const fray_world *w, uint32_t t, uint32_t k) {
  const layer_box *b = &w->layer_boxes[t];
  return wrap_sub(w->ways[b->v[k]].begin, w->tiles[b->tile].gone);
}
static int32_t gone_of(const fray_world *w, uint32_t t) {
  int32_t most = 0;
  for (uint32_t k = 0; k < 3; ++k) most = fx_max(most, length_most(wrap_sub(place_of(w, t, k), w->layer_ways[t].from[k])));
  return most;
}

static uint32_t tiles_of(const fray_world *w) { return w->listed.across * w->listed.across; }

/* Of the tick before. */
void layers_went(fray_world *w) {
  layer_tile *tile = w->tiles;
  if (w->listed.kept == 0) return;
  for (uint32_t a = 0; a < tiles_of(w); ++a) {
    tile[a].gone = vec_make(fx_wrap_add(tile[a].gone.x, tile[a].mean.x), fx_wrap_add(tile[a].gone.y, tile[a].mean.y),
                            fx_wrap_add(tile[a].gone.z, tile[a].mean.z));
    tile[a].mean = vec_make(0, 0, 0);
  }
}

/* Two that are farther apart do not meet, if they do not go anywhere. */
static int64_t least_apart(const fray_world *w) {
  return (int64_t)w->selves->thickness + 4 * (int64_t)w->selves->slack;
}

/* How far corners of the second go beside those of the first in this tick, at most. */
static int64_t gone_beside(const fray_world *w, const layer_pair *pair) {
  const uint32_t as = layer_firsts(pair);
  int32_t most = 0;
  for (uint32_t m = 0; m < as; ++m)
    for (uint32_t n = as; n < 4; ++n) {
      const self_way *a = &w->ways[pair->p[m]];
      const self_way *b = &w->ways[pair->p[n]];
      most = fx_max(most, gone_by(b->begin, b->end, vec_sub(a->end, a->begin)));
    }
  return most;
}

static int may_meet(const fray_world *w, const layer_pair *pair, sweep_gap gap) {
  const int64_t least = least_apart(w);
  return (gap.begin <= least || gap.end <= least) && gap.begin <= least + gone_beside(w, pair);
}

static layer_beside *between(const fray_world *w, uint32_t a, uint32_t b) {
  return a > b ? &w->tiles_beside[a * (a - 1u) / 2u + b] : &w->tiles_beside[b * (b - 1u) / 2u + a];
}

/* ---- boxes ---- */

static uint8_t bits_of_own(const fray_world *w, uint32_t t) {
  const sheet_triangle *f = &w->sheet.triangle[t];
  uint32_t own = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    if (w->sheet.fan[f->v[k]] == t) own |= 1u << k;
    if (f->across[k] >= t) own |= 8u << k;
  }
  return (uint8_t)own;
}

/* `more` around it. */
static void box_of(fray_world *w, uint32_t t, int32_t more) {
  layer_box *b = &w->layer_boxes[t];
  const vec3 p = w->ways[b->v[0]].begin;
  const vec3 q = w->ways[b->v[1]].begin;
  const vec3 r = w->ways[b->v[2]].begin;
  b->low[0] = fx_sub(fx_min(fx_min(p.x, q.x), r.x), more);
  b->low[1] = fx_sub(fx_min(fx_min(p.y, q.y), r.y), more);
  b->low[2] = fx_sub(fx_min(fx_min(p.z, q.z), r.z), more);
  b->high[0] = fx_add(fx_max(fx_max(p.x, q.x), r.x), more);
  b->high[1] = fx_add(fx_max(fx_max(p.y, q.y), r.y), more);
  b->high[2] = fx_add(fx_max(fx_max(p.z, q.z), r.z), more);
}

static inline int overlap(const int32_t *low, const int32_t *high, const int32_t *other_low, const int32_t *other_high) {
  return low[0] <= other_high[0] && other_low[0] <= high[0] && low[1] <= other_high[1] && other_low[1] <= high[1] &&
         low[2] <= other_high[2] && other_low[2] <= high[2];
}

/* ---- tiles ---- */

static uint32_t part_along(const layer_list *l, int32_t at, uint32_t axis) {
  const int64_t n = ((int64_t)at - l->low[axis]) / l->size[axis];
  return (uint32_t)fx_clamp64(n, 0, (int64_t)l->across * LAYERS_PARTS - 1);
}

/* By the middle of a triangle at rest. */
static void find_tile(fray_world *w, uint32_t t) {
  const sheet_mesh *s = &w->sheet;
  const row_id *v = s->triangle[t].v;
  layer_box *b = &w->layer_boxes[t];
  const int32_t u = s->u[v[0]] / 3 + s->u[v[1]] / 3 + s->u[v[2]] / 3;
  const int32_t at = s->v[v[0]] / 3 + s->v[v[1]] / 3 + s->v[v[2]] / 3;
  const uint32_t i = part_along(&w->listed, u, 0);
  const uint32_t j = part_along(&w->listed, at, 1);
  b->tile = (uint8_t)(j / LAYERS_PARTS * w->listed.across + i / LAYERS_PARTS);
  b->part = (uint8_t)(j % LAYERS_PARTS * LAYERS_PARTS + i % LAYERS_PARTS);
}

static void find_rest(fray_world *w) {
  layer_list *l = &w->listed;
  const int32_t *const at[2] = {w->sheet.u, w->sheet.v};
  l->across = layers_across(triangles_of(w));
  for (uint32_t k = 0; k < 2; ++k) {
    int32_t high = l->low[k] = at[k][0];
    for (uint32_t p = 1; p < w->particles; ++p) {
      l->low[k] = fx_min(l->low[k], at[k][p]);
      high = fx_max(high, at[k][p]);
    }
    l->size[k] = fx_sub(high, l->low[k]) / ((int32_t)l->across * LAYERS_PARTS) + 1;
  }
}

/* Triangles by tiles and their parts, in order of their numbers. */
static void fill_tiles(fray_world *w) {
  enum { PARTS = LAYERS_PARTS * LAYERS_PARTS };
  layer_tile *tile = w->tiles;
  uint32_t from[LAYERS_TILES * PARTS];
  uint32_t sum = 0;
  for (uint32_t n = 0; n < tiles_of(w) * PARTS; ++n) from[n] = 0;
  for (uint32_t t = 0; t < triangles_of(w); ++t) ++from[w->layer_boxes[t].tile * PARTS + w->layer_boxes[t].part];
  for (uint32_t n = 0; n < tiles_of(w) * PARTS; ++n) {
    const uint32_t count = from[n];
    from[n] = sum;
    if (n % PARTS == 0) tile[n / PARTS].first = sum;
    sum += count;
    tile[n / PARTS].end = sum;
  }
  for (uint32_t t = 0; t < triangles_of(w); ++t)
    w->layer_order[from[w->layer_boxes[t].tile * PARTS + w->layer_boxes[t].part]++] = (row_id)t;
}

static const layer_clump around_nothing = {{INT32_MAX, INT32_MAX, INT32_MAX}, {-INT32_MAX, -INT32_MAX, -INT32_MAX}};

static void widen_by(int32_t *low, int32_t *high, int64_t by) {
  for (uint32_t k = 0; k < 3; ++k) {
    low[k] = fx_saturate(low[k] - by);
    high[k] = fx_saturate(high[k] + by);
  }
}
static void widen(int32_t *low, int32_t *high, const int32_t *other_low, const int32_t *other_high) {
  for (uint32_t k = 0; k < 3; ++k) {
    low[k] = fx_min(low[k], other_low[k]);
    high[k] = fx_max(high[k], other_high[k]);
  }
}

/* Around the triangles of it from n on, in clumps, each in the place of its first. */
static void box_tile(fray_world *w, layer_tile *tile) {
  layer_clump all = around_nothing;
  for (uint32_t first = tile->first; first < tile->end; first += LAYERS_CLUMP) {
    layer_clump *clump = &w->layer_clumps[first];
    *clump = around_nothing;
    for (uint32_t n = first; n < tile->end && n < first + LAYERS_CLUMP; ++n) {
      const layer_box *b = &w->layer_boxes[w->layer_order[n]];
      widen(clump->low, clump->high, b->low, b->high);
    }
    widen(all.low, all.high, clump->low, clump->high);
  }
  for (uint32_t k = 0; k < 3; ++k) {
    tile->low[k] = all.low[k];
    tile->high[k] = all.high[k];
  }
}

/* ---- what has changed ---- */

/* A triangle that is listed for the first time, or is another one now. */
static void renew(fray_world *w, uint32_t t) {
  layer_box *b = &w->layer_boxes[t];
  for (uint32_t k = 0; k < 3; ++k) b->v[k] = w->sheet.triangle[t].v[k];
  b->own = bits_of_own(w, t);
  b->hot = 0;
  find_tile(w, t);
  w->layer_ways[t].room = -1;
}

static int is_changed(const fray_world *w, uint32_t t) {
  const row_id *v = w->sheet.triangle[t].v;
  const layer_box *b = &w->layer_boxes[t];
  return t >= w->listed.triangles || v[0] != b->v[0] || v[1] != b->v[1] || v[2] != b->v[2] || bits_of_own(w, t) != b->own;
}

static void remember(fray_world *w) {
  layer_list *l = &w->listed;
  fill_tiles(w);
  l->particles = w->particles;
  l->triangles = triangles_of(w);
  l->topology[0] = w->state->topology[0];
  l->topology[1] = w->state->topology[1];
}

/* Nothing is listed: all triangles are stale, all tiles far from each other. */
static void begin_list(fray_world *w) {
  layer_list *l = &w->listed;
  layer_tile *of = w->tiles;
  int64_t wide = 0;
  find_rest(w);
  for (uint32_t t = 0; t < triangles_of(w); ++t) {
    renew(w, t);
    box_of(w, t, 0);
    const layer_box *b = &w->layer_boxes[t];
    wide += fx_max(fx_max(fx_sub(b->high[0], b->low[0]), fx_sub(b->high[1], b->low[1])), fx_sub(b->high[2], b->low[2]));
  }
  for (uint32_t a = 0; a < tiles_of(w); ++a) {
    of[a].gone = of[a].mean = vec_make(0, 0, 0);
    for (uint32_t b = 0; b < a; ++b) between(w, a, b)->room = -1;
  }
  l->usual = (int32_t)(wide / triangles_of(w) / USUAL) + 1;
  l->pairs = 0;
  l->kept = 1;
  remember(w);
}

static void follow_sheet(fray_world *w) {
  const layer_list *l = &w->listed;
  if (l->topology[0] == w->state->topology[0] && l->topology[1] == w->state->topology[1] && l->particles == w->particles &&
      l->triangles == triangles_of(w))
    return;
  for (uint32_t t = 0; t < triangles_of(w); ++t)
    if (is_changed(w, t)) renew(w, t);
  remember(w);
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
  w->layers_met[w->listed.met++] = n;
}

static void add_pair(fray_world *w, layer_pair *pair, int64_t reach) {
  layer_list *l = &w->listed;
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
    d->common[k] = (uint32_t)(p == d->v[1][0]) | (uint32_t)(p == d->v[1][1]) << 1 | (uint32_t)(p == d->v[1][2]) << 2;
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

static int64_t room_of(const fray_world *w, uint32_t t) { return (int64_t)w->layer_ways[t].room + w->layer_ways[t].gone; }

/* Those that are no more where they were listed, or will not be, are to be listed. */
static void find_stale(fray_world *w) {
  layer_list *l = &w->listed;
  layer_tile *of = w->tiles;
  l->stale = 0;
  for (uint32_t a = 0; a < tiles_of(w); ++a) of[a].mean = mean_of(w, &of[a]);
  for (uint32_t t = 0; t < triangles_of(w); ++t) {
    layer_way *way = &w->layer_ways[t];
    const int32_t goes = goes_by(w, t);
    l->wild |= (uint32_t)(goes == TOO_FAR);
    way->gone = way->room < 0 ? 0 : gone_of(w, t);
    w->layer_soon[t] = way->gone + goes;
    if (l->tight == 0 && w->layer_boxes[t].hot == 0 && w->layer_soon[t] <= way->room) continue;
    w->layer_boxes[t].hot = l->tight != 0 || (int64_t)FAST * goes > l->usual;
    for (uint32_t k = 0; k < 3; ++k) way->from[k] = place_of(w, t, k);
    way->gone = 0;
    way->room = w->layer_boxes[t].hot != 0 ? goes : l->usual;
    w->layer_soon[t] = LAYERS_STALE;
    w->layer_stale[l->stale++] = (row_id)t;
  }
  for (uint32_t t = 0; t < triangles_of(w); ++t) box_of(w, t, fx_saturate(least_apart(w) / 2 + 1 + room_of(w, t)));
  for (uint32_t a = 0; a < tiles_of(w); ++a) box_tile(w, &of[a]);
}

/* Tiles that are near each other and are not listed, or are no more beside each other as they were. */
static void find_stale_tiles(fray_world *w) {
  layer_list *l = &w->listed;
  layer_tile *of = w->tiles;
  for (uint32_t a = 0; a < tiles_of(w); ++a) of[a].near = (uint64_t)1 << a;
  for (uint32_t a = 0; a < tiles_of(w); ++a)
    for (uint32_t b = 0; b < a; ++b) {
      layer_beside *pair = between(w, a, b);
      const layer_tile *one = &of[a];
      layer_tile wider;
      const vec3 from = wrap_sub(of[a].gone, of[b].gone);
      const int32_t goes = gone_by(of[a].mean, of[b].mean, vec_make(0, 0, 0));
      l->wild |= (uint32_t)(goes == TOO_FAR);
      const int32_t room = l->tight != 0 ? goes : fx_max(fx_saturate((int64_t)FAST * goes), l->usual);
      pair->gone = pair->room < 0 ? 0 : length_most(wrap_sub(from, pair->from));
      pair->soon = pair->gone + goes;
      if (pair->soon <= pair->room) {
        of[a].near |= (uint64_t)1 << b;
        of[b].near |= (uint64_t)1 << a;
        continue;
      }
      pair->soon = LAYERS_STALE;
      pair->room = -1;
      wider = *one;
      widen_by(wider.low, wider.high, room);
      if (!overlap(wider.low, wider.high, of[b].low, of[b].high)) continue;
      pair->from = from;
      pair->gone = 0;
      pair->room = room;
    }
}

/* What two tiles may still go beside each other from where they are. */
static int64_t room_between(const fray_world *w, uint32_t a, uint32_t b) {
  return a == b ? 0 : (int64_t)between(w, a, b)->room + between(w, a, b)->gone;
}
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
  for (uint32_t n = of->first; n < of->end && w->listed.lacks == 0; n += LAYERS_CLUMP) {
    const layer_clump *clump = &w->layer_clumps[n];
    ++w->work.self_visits;
    if (overlap(box.low, box.high, clump->low, clump->high))
      list_clump(w, &box, t, n, n + LAYERS_CLUMP < of->end ? n + LAYERS_CLUMP : of->end, room, all);
  }
}

/* With those of all tiles that are listed together. */
static void list_near(fray_world *w, uint32_t t, uint64_t tiles) {
  for (uint64_t left = tiles; left != 0 && w->listed.lacks == 0; left &= left - 1u)
    list_with(w, t, 63u - fx_leading_zeros64(left & (~left + 1u)), 0);
}

static void list_tiles(fray_world *w, uint32_t a, uint32_t b) {
  const layer_tile *of = &w->tiles[a];
  for (uint32_t n = of->first; n < of->end && w->listed.lacks == 0; ++n) list_with(w, w->layer_order[n], b, 1);
}

/* What was listed: without what is stale, and what may meet. */
static void look_at_list(fray_world *w) {
  layer_list *l = &w->listed;
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
  layer_list *l = &w->listed;
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
  layer_list *l = &w->listed;
  begin_list(w);
  l->kept = l->full = l->lacks = l->met = 0;
  l->tight = 1;
  find_stale(w);
  find_stale_tiles(w);
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
  const uint32_t met = w->listed.met;
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
  layer_list *l = &w->listed;
  l->tight = l->met = l->wild = 0;
  if (l->kept == 0)
    begin_list(w);
  else
    follow_sheet(w);
  find_stale(w);
  find_stale_tiles(w);
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
