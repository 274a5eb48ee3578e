/* SPDX-License-Identifier: Apache-2.0 */
/* Which vertices and triangles, and which sides, may meet in a tick.
 *
 * A list of all that is near each other is kept from tick to tick, with more in it than a tick needs. Each
 * triangle has room to go; when that is used up it alone is looked for again. Each pair says how far its two may
 * go, together, until they can meet, by what separated them when they were looked at last. All count the ways of a
 * triangle's corners, by the longest, less the mean of all: what everything moves by brings nothing nearer.
 *
 * What may meet in this tick is those that are no farther apart than the thickness and what they go beside each
 * other, and that the direction in which they are nearest when it begins does not separate when it ends. That follows
 * from the state and the ways of the tick alone. So the list is no state: one that has more, or was made at another
 * time, gives the same result to the last bit. It is made anew when the sheet has torn, and in a world just opened.
 *
 * Boxes of triangles stand in cells, by their lower corner; each looks into 27. Those that are wider than a cell
 * stand in a list of their own. */
#include "rt/stage/layers.h"

enum {
  FAR = 64,        /* lu: nothing stands lower */
  SHORT = 24,      /* segments of the list that are put in order one by one */
  FAST = 4,        /* room of a triangle, in ways of this tick, at least */
  PATH_MOST = 1 << 28,
  STALE = INT32_MAX /* layer_soon of what is to be listed again */
};

/* ---- ways ---- */

static vec3 mean_of(const int64_t sum[3], uint32_t count) {
  const int64_t of = count;
  return vec_make((int32_t)(sum[0] / of), (int32_t)(sum[1] / of), (int32_t)(sum[2] / of));
}

static int32_t gone_by(vec3 from, vec3 to, vec3 mean) {
  const int64_t way[3] = {(int64_t)to.x - from.x - mean.x, (int64_t)to.y - from.y - mean.y, (int64_t)to.z - from.z - mean.z};
  const int64_t most = PATH_MOST / 4;
  for (uint32_t k = 0; k < 3; ++k)
    if (way[k] > most || way[k] < -most) return PATH_MOST;
  return zones_length(vec_make((int32_t)way[0], (int32_t)way[1], (int32_t)way[2]));
}

/* How far each vertex goes from where the tick began; `past`: how far it went there from where the last one did. */
static void measure(fray_world *w, int past) {
  int64_t sum[3] = {0, 0, 0};
  for (uint32_t p = 0; p < w->particles; ++p) {
    const vec3 from = w->ways[p].begin;
    const vec3 to = past ? world_position(w, p) : w->ways[p].end;
    sum[0] += (int64_t)to.x - from.x;
    sum[1] += (int64_t)to.y - from.y;
    sum[2] += (int64_t)to.z - from.z;
  }
  const vec3 mean = mean_of(sum, w->particles);
  for (uint32_t p = 0; p < w->particles; ++p)
    w->layers_gone[p] = gone_by(w->ways[p].begin, past ? world_position(w, p) : w->ways[p].end, mean);
}

static int32_t gone_of(const fray_world *w, uint32_t t) {
  const row_id *v = w->sheet.triangle[t].v;
  return fx_max(fx_max(w->layers_gone[v[0]], w->layers_gone[v[1]]), w->layers_gone[v[2]]);
}

static int is_same_sheet(const fray_world *w) {
  return w->listed.particles == w->particles && w->listed.topology[0] == w->state->topology[0] &&
         w->listed.topology[1] == w->state->topology[1];
}

void layers_went(fray_world *w) {
  layer_list *l = &w->listed;
  if (l->kept != 0 && !is_same_sheet(w)) l->kept = 0;
  if (l->kept == 0) return;
  measure(w, 1);
  for (uint32_t t = 0; t < (uint32_t)w->sheet.state->triangles; ++t) {
    layer_way *way = &w->layer_ways[t];
    way->path += gone_of(w, t);
    if (way->path > PATH_MOST) l->kept = 0;
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
static int32_t box_of(fray_world *w, uint32_t t, int64_t more) {
  const row_id *v = w->sheet.triangle[t].v;
  layer_box *b = &w->layer_boxes[t];
  int32_t widest = 0;
  const vec3 p = w->ways[v[0]].begin;
  const vec3 q = w->ways[v[1]].begin;
  const vec3 r = w->ways[v[2]].begin;
  const int32_t at[3][3] = {{p.x, q.x, r.x}, {p.y, q.y, r.y}, {p.z, q.z, r.z}};
  for (uint32_t k = 0; k < 3; ++k) {
    b->low[k] = fx_saturate(fx_min(fx_min(at[k][0], at[k][1]), at[k][2]) - more);
    b->high[k] = fx_saturate(fx_max(fx_max(at[k][0], at[k][1]), at[k][2]) + more);
    widest = fx_max(widest, fx_saturate((int64_t)b->high[k] - b->low[k]));
  }
  return widest;
}

static uint32_t cell_at(const layer_list *l, const uint32_t at[3]) {
  const uint32_t mixed = fx_wrap_mul_u(at[0], 73856093u) ^ fx_wrap_mul_u(at[1], 19349663u) ^
                         fx_wrap_mul_u(at[2], 83492791u);
  return (mixed ^ mixed >> 15) & (l->cells - 1u);
}

static void clear_cells(fray_world *w) {
  layer_list *l = &w->listed;
  l->cells = 1;
  while (l->cells < (uint32_t)w->sheet.state->triangles) l->cells += l->cells;
  for (uint32_t n = 0; n < l->cells; ++n) w->layer_cells[n] = LAYERS_NOBODY;
  l->wide = 0;
}

static void put_box(fray_world *w, uint32_t t) {
  layer_list *l = &w->listed;
  layer_box *b = &w->layer_boxes[t];
  if (box_of(w, t, least_apart(w) / 2 + 1 + w->layer_ways[t].room) > l->cell) {
    w->layer_wide[l->wide++] = (row_id)t;
    b->cell[0] = 0;
    return;
  }
  for (uint32_t k = 0; k < 3; ++k)
    b->cell[k] = 1u + (uint32_t)(((int64_t)b->low[k] + ((int64_t)FAR << FX_POSITION_BITS)) / l->cell);
  const uint32_t cell = cell_at(l, b->cell);
  w->layer_next[t] = w->layer_cells[cell];
  w->layer_cells[cell] = (row_id)t;
}

static int overlap(const layer_box *a, const layer_box *b) {
  return a->low[0] <= b->high[0] && b->low[0] <= a->high[0] && a->low[1] <= b->high[1] &&
         b->low[1] <= a->high[1] && a->low[2] <= b->high[2] && b->low[2] <= a->high[2];
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

/* Of a pair that stands in the list. */
static void look_at(fray_world *w, uint32_t n, sweep_gap gap) {
  layer_pair *pair = &w->layers[n];
  const int64_t left = (int64_t)gap.begin - least_apart(w);
  const int64_t path = (int64_t)w->layer_ways[pair->of[0]].path + w->layer_ways[pair->of[1]].path;
  pair->until = fx_saturate(path + left);
  if (left > 0 && (int64_t)w->layer_soon[pair->of[0]] + w->layer_soon[pair->of[1]] < pair->until) return;
  if (!may_meet(w, pair, gap) || are_one(w, pair)) return;
  pair->looked = pair->near = 0;
  w->layers_met[w->listed.met++] = n;
}

static void add_pair(fray_world *w, layer_pair *pair, int64_t reach) {
  layer_list *l = &w->listed;
  const sweep_gap gap = layers_gap(w, pair);
  if (gap.begin > reach || (l->tight != 0 && !may_meet(w, pair, gap))) return;
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
  return (int64_t)fx_min(b0, b1) - fx_max(a0, a1) > reach || (int64_t)fx_min(a0, a1) - fx_max(b0, b1) > reach;
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
  return (int64_t)fx_min(fx_min(a, b), c) - p > reach || (int64_t)p - fx_max(fx_max(a, b), c) > reach;
}
static int corner_is_off(const duo *d, uint32_t of, uint32_t k) {
  const vec3 p = d->at[of][k];
  const vec3 *t = d->at[1u - of];
  return is_off(p.x, t[0].x, t[1].x, t[2].x, d->reach) || is_off(p.y, t[0].y, t[1].y, t[2].y, d->reach) ||
         is_off(p.z, t[0].z, t[1].z, t[2].z, d->reach);
}

static int32_t between(int32_t a, int32_t b, int32_t c, int32_t d, int32_t e, int32_t f) {
  return fx_asr(d, 5) + fx_asr(e, 5) + fx_asr(f, 5) - fx_asr(a, 5) - fx_asr(b, 5) - fx_asr(c, 5);
}
/* The second's corners are beyond the first's along the way between their middles, farther than anything that is
 * listed: so are all their parts. */
static int are_parted(const duo *d) {
  const vec3 *a = d->at[0];
  const vec3 *b = d->at[1];
  const vec3 way = vec_make(between(a[0].x, a[1].x, a[2].x, b[0].x, b[1].x, b[2].x),
                            between(a[0].y, a[1].y, a[2].y, b[0].y, b[1].y, b[2].y),
                            between(a[0].z, a[1].z, a[2].z, b[0].z, b[1].z, b[2].z));
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
  d->reach = fx_saturate(least_apart(w) + w->layer_ways[t].room + w->layer_ways[other].room);
  return common;
}

/* Whose vertices and sides they are to look at. What has a vertex in common does not meet. */
static void meet(fray_world *w, uint32_t t, uint32_t other) {
  duo d;
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

/* Two that are both to be listed meet when the one with the greater number is. */
static int is_later(const fray_world *w, uint32_t t, uint32_t other) {
  return other == t || (other > t && w->layer_soon[other] == STALE);
}

static void try_other(fray_world *w, uint32_t t, uint32_t other) {
  ++w->work.self_visits;
  if (!is_later(w, t, other) && overlap(&w->layer_boxes[t], &w->layer_boxes[other])) meet(w, t, other);
}

static void look_into(fray_world *w, uint32_t t, const uint32_t at[3]) {
  row_id other = w->layer_cells[cell_at(&w->listed, at)];
  for (; other != LAYERS_NOBODY; other = w->layer_next[other]) {
    const layer_box *o = &w->layer_boxes[other];
    if (o->cell[0] == at[0] && o->cell[1] == at[1] && o->cell[2] == at[2]) try_other(w, t, other);
  }
}

/* All pairs of a triangle with others. */
static void list_triangle(fray_world *w, uint32_t t) {
  const layer_box *b = &w->layer_boxes[t];
  uint32_t at[3];
  if (b->cell[0] == 0) {
    for (uint32_t other = 0; other < (uint32_t)w->sheet.state->triangles; ++other) try_other(w, t, other);
    return;
  }
  for (at[0] = b->cell[0] - 1u; at[0] <= b->cell[0] + 1u; ++at[0])
    for (at[1] = b->cell[1] - 1u; at[1] <= b->cell[1] + 1u; ++at[1])
      for (at[2] = b->cell[2] - 1u; at[2] <= b->cell[2] + 1u; ++at[2]) look_into(w, t, at);
  for (uint32_t n = 0; n < w->listed.wide; ++n) try_other(w, t, w->layer_wide[n]);
}

static void put_all(fray_world *w) {
  clear_cells(w);
  for (uint32_t t = 0; t < (uint32_t)w->sheet.state->triangles; ++t) put_box(w, t);
}

static void give_room(fray_world *w, uint32_t t, int32_t usual) {
  layer_way *way = &w->layer_ways[t];
  const int32_t soon = fx_saturate((int64_t)FAST * gone_of(w, t));
  way->room = usual == 0 ? gone_of(w, t) : fx_max(soon, usual);
  way->limit = fx_saturate((int64_t)way->path + way->room);
}

/* All triangles, from nothing. */
static void begin_list(fray_world *w) {
  layer_list *l = &w->listed;
  const uint32_t triangles = (uint32_t)w->sheet.state->triangles;
  int64_t wide = 0;
  for (uint32_t t = 0; t < triangles; ++t) {
    wide += box_of(w, t, 0);
    w->layer_boxes[t].own = bits_of_own(w, t);
    w->layer_ways[t].path = 0;
    w->layer_soon[t] = STALE;
    w->layer_stale[t] = (row_id)t;
  }
  l->stale = triangles;
  l->pairs = l->met = 0;
  l->usual = (int32_t)(wide / triangles / 4) + 1;
  l->cell = fx_saturate(2 * wide / triangles + 4 * (int64_t)l->usual + least_apart(w));
  l->particles = w->particles;
  l->topology[0] = w->state->topology[0];
  l->topology[1] = w->state->topology[1];
  l->kept = 1;
}

/* Those whose room is used up. */
static void find_stale(fray_world *w) {
  layer_list *l = &w->listed;
  l->stale = l->met = 0;
  for (uint32_t t = 0; t < (uint32_t)w->sheet.state->triangles; ++t) {
    const layer_way *way = &w->layer_ways[t];
    const int64_t soon = (int64_t)way->path + gone_of(w, t);
    w->layer_soon[t] = soon > way->limit ? STALE : (int32_t)soon;
    if (soon > way->limit) w->layer_stale[l->stale++] = (row_id)t;
  }
}

/* What was listed: without what stale triangles have, and what may meet. */
static void look_at_list(fray_world *w) {
  layer_list *l = &w->listed;
  uint32_t kept = 0;
  for (uint32_t n = 0; n < l->pairs; ++n) {
    const layer_pair *pair = &w->layers[n];
    const int64_t soon = (int64_t)w->layer_soon[pair->of[0]] + w->layer_soon[pair->of[1]];
    if (soon >= STALE) continue; /* two that are not add up to less */
    if (kept != n) w->layers[kept] = *pair;
    ++kept;
    if (soon >= w->layers[kept - 1u].until) look_at(w, kept - 1u, layers_gap(w, &w->layers[kept - 1u]));
  }
  l->pairs = kept;
}

/* Then the stale ones again. Returns 0 where there is no room. */
static int list_stale(fray_world *w) {
  layer_list *l = &w->listed;
  l->tight = l->full = l->lacks = 0;
  if (l->stale == 0) return 1;
  for (uint32_t n = 0; n < l->stale; ++n) give_room(w, w->layer_stale[n], l->usual);
  put_all(w);
  for (uint32_t n = 0; n < l->stale && l->lacks == 0; ++n) list_triangle(w, w->layer_stale[n]);
  return l->lacks == 0;
}

/* Only what may meet in this tick, triangle after triangle. What there is no room for is joined, from the first
 * triangle on of which there is something. */
static void list_tight(fray_world *w) {
  layer_list *l = &w->listed;
  begin_list(w);
  l->kept = 0;
  l->tight = 1;
  l->full = l->lacks = 0;
  for (uint32_t t = 0; t < l->stale; ++t) give_room(w, t, 0);
  put_all(w);
  for (uint32_t t = 0; t < l->stale; ++t) {
    const uint32_t first = l->pairs;
    const uint32_t met = l->met;
    list_triangle(w, t);
    if (l->lacks == 0) continue;
    l->lacks = 0;
    l->full = 1;
    l->pairs = first;
    l->met = met;
    w->state->faults |= (int32_t)FRAY_FAULT_SELVES;
    list_triangle(w, t);
  }
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
  const uint32_t triangles = (uint32_t)w->sheet.state->triangles;
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

void layers_find(fray_world *w) {
  layer_list *l = &w->listed;
  measure(w, 0);
  if (l->kept == 0) {
    begin_list(w);
  } else {
    find_stale(w);
    look_at_list(w);
  }
  if (!list_stale(w)) list_tight(w);
  order_met(w);
  w->work.self_pairs += l->met;
}
