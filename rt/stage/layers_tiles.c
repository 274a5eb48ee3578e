/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/stage/layers_tiles.h"

#include "rt/stage/layers.h"

enum {
  FAST = 1,  /* what goes farther in a tick than that part of its room is looked at in every one */
  USUAL = 8  /* room: that part of how wide triangles are */
};

/* ---- ways ---- */

int32_t tiles_gone_by(vec3 from, vec3 to, vec3 mean) {
  const int64_t way[3] = {(int64_t)to.x - from.x - mean.x, (int64_t)to.y - from.y - mean.y, (int64_t)to.z - from.z - mean.z};
  const int64_t most = LAYERS_PATH_MOST / 2;
  for (uint32_t k = 0; k < 3; ++k)
    if (way[k] > most || way[k] < -most) return LAYERS_TOO_FAR;
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
  const uint32_t most = LAYERS_PATH_MOST / 2;
  if (fx_magnitude(v.x) > most || fx_magnitude(v.y) > most || fx_magnitude(v.z) > most) return LAYERS_TOO_FAR;
  return zones_length(v);
}

/* In this tick. */
static int32_t goes_by(const fray_world *w, uint32_t t) {
  const layer_box *b = &w->layer_boxes[t];
  const vec3 mean = w->tiles[b->tile].mean;
  int32_t most = 0;
  for (uint32_t k = 0; k < 3; ++k) most = fx_max(most, tiles_gone_by(w->ways[b->v[k]].begin, w->ways[b->v[k]].end, mean));
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

/* Of the tick before. */
void layers_went(fray_world *w) {
  layer_tile *tile = w->tiles;
  if (w->listed->kept == 0) return;
  for (uint32_t a = 0; a < tiles_of(w); ++a) {
    tile[a].gone = vec_make(fx_wrap_add(tile[a].gone.x, tile[a].mean.x), fx_wrap_add(tile[a].gone.y, tile[a].mean.y),
                            fx_wrap_add(tile[a].gone.z, tile[a].mean.z));
    tile[a].mean = vec_make(0, 0, 0);
  }
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
  const uint32_t i = part_along(w->listed, u, 0);
  const uint32_t j = part_along(w->listed, at, 1);
  b->tile = (uint8_t)(j / LAYERS_PARTS * w->listed->across + i / LAYERS_PARTS);
  b->part = (uint8_t)(j % LAYERS_PARTS * LAYERS_PARTS + i % LAYERS_PARTS);
}

static void find_rest(fray_world *w) {
  layer_list *l = w->listed;
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
  return t >= w->listed->triangles || v[0] != b->v[0] || v[1] != b->v[1] || v[2] != b->v[2] || bits_of_own(w, t) != b->own;
}

static void remember(fray_world *w) {
  layer_list *l = w->listed;
  fill_tiles(w);
  l->particles = w->particles;
  l->triangles = triangles_of(w);
  l->topology[0] = w->state->topology[0];
  l->topology[1] = w->state->topology[1];
}

/* Nothing is listed: all triangles are stale, all tiles far from each other. */
void tiles_begin(fray_world *w) {
  layer_list *l = w->listed;
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

void tiles_follow(fray_world *w) {
  const layer_list *l = w->listed;
  if (l->topology[0] == w->state->topology[0] && l->topology[1] == w->state->topology[1] && l->particles == w->particles &&
      l->triangles == triangles_of(w))
    return;
  for (uint32_t t = 0; t < triangles_of(w); ++t)
    if (is_changed(w, t)) renew(w, t);
  remember(w);
}

/* ---- who is to be listed ---- */

/* Those that are no more where they were listed, or will not be, are to be listed. */
void tiles_find_stale(fray_world *w) {
  layer_list *l = w->listed;
  layer_tile *of = w->tiles;
  l->stale = 0;
  for (uint32_t a = 0; a < tiles_of(w); ++a) of[a].mean = mean_of(w, &of[a]);
  for (uint32_t t = 0; t < triangles_of(w); ++t) {
    layer_way *way = &w->layer_ways[t];
    const int32_t goes = goes_by(w, t);
    l->wild |= goes == LAYERS_TOO_FAR ? 1u : 0u;
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
void tiles_find_beside(fray_world *w) {
  layer_list *l = w->listed;
  layer_tile *of = w->tiles;
  for (uint32_t a = 0; a < tiles_of(w); ++a) of[a].near = (uint64_t)1 << a;
  for (uint32_t a = 0; a < tiles_of(w); ++a)
    for (uint32_t b = 0; b < a; ++b) {
      layer_beside *pair = between(w, a, b);
      const layer_tile *one = &of[a];
      layer_tile wider;
      const vec3 from = wrap_sub(of[a].gone, of[b].gone);
      const int32_t goes = tiles_gone_by(of[a].mean, of[b].mean, vec_make(0, 0, 0));
      l->wild |= goes == LAYERS_TOO_FAR ? 1u : 0u;
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

