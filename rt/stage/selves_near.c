/* SPDX-License-Identifier: Apache-2.0 */
/* Which segments of a sheet may meet in a tick, from where all particles began and would end.
 *
 * The sheet is a grid, so what is near whom follows from two things, in axes u along its wefts, v along
 * its warps and n across, as the sheet lies as a whole:
 *
 * - A tree over the grid: boxes around what crossings and their segments take up at the tick's begin, and
 *   at its end. Two of which one is beyond the other at both, along one axis, have nothing to do with
 *   each other.
 * - A part of the grid in which every way to the next crossing along a weft goes on along u by more than
 *   it strays along v, and every way along a warp the other way round, at the tick's begin and at its end,
 *   and so in between. In the plane of u and v that part is spread out as the grid is: of two segments
 *   that share no crossing one is beyond the other, or on one side of the line through it, by what the
 *   weakest link goes on over root 2. So no two of them meet, however the sheet is curved across. Sums of
 *   what is not so over all rectangles from the corner tell of any rectangle at once whether it is.
 *
 * So a sheet that hangs in pleats costs one look at its root; what is torn or folded is looked at in
 * parts. Both hold for ends anywhere within the slack. */
#include "rt/model/couples.h"
#include "rt/stage/selves.h"

enum {
  COARSE = 10,            /* bits that axes have, and that positions lack */
  ROUNDING = 1 << 13,     /* of differences of two fields, and more */
  SAMPLES = 8,            /* along each side of a quarter of the sheet */
  STACK = 16 * SELVES_LEVELS
};

typedef struct {
  int32_t axis[3][3]; /* Q10 */
} frame;

/* Levels of the tree: level 0 has a node for each crossing. */
typedef struct {
  uint32_t levels;
  uint32_t first[SELVES_LEVELS], columns[SELVES_LEVELS], rows[SELVES_LEVELS];
} tree;

/* A node of a level, by column and row; two of them. */
typedef struct {
  uint32_t i, j;
} node;
typedef struct {
  node a, b;
  uint32_t level;
} visit;

/* In one word, each of them in 13 bits: what is put on the stack is taken off at once, and cores wait where
 * that is written in parts and read whole. */
static inline uint64_t packed(node a, node b, uint32_t level) {
  return (uint64_t)(a.i << 13 | a.j) << 30 | (uint64_t)(b.i << 13 | b.j) << 4 | level;
}
static inline visit unpacked(uint64_t word) {
  const uint32_t high = (uint32_t)(word >> 30);
  const uint32_t low = (uint32_t)(word >> 4) & ((1u << 26) - 1u);
  const visit v = {{high >> 13, high & 8191u}, {low >> 13, low & 8191u}, (uint32_t)word & 15u};
  return v;
}

static void add_way(int64_t sum[3], vec3 from, vec3 to) {
  sum[0] += (int64_t)to.x - from.x;
  sum[1] += (int64_t)to.y - from.y;
  sum[2] += (int64_t)to.z - from.z;
}

/* To at most 28 bits. */
static vec3 narrowed(const int64_t v[3]) {
  uint64_t all = 0;
  for (uint32_t k = 0; k < 3; ++k) all |= (uint64_t)(v[k] < 0 ? -v[k] : v[k]);
  unsigned shift = 0;
  while (all >> shift >= (uint64_t)1 << 28) ++shift;
  return vec_make((int32_t)fx_asr64(v[0], shift), (int32_t)fx_asr64(v[1], shift),
                  (int32_t)fx_asr64(v[2], shift));
}

/* Q30; another unit vector where there is none. */
static vec3 axis_unit(vec3 v, vec3 otherwise) {
  const uint64_t squared = vec_squared(v);
  if (squared < 1u << 16) return otherwise;
  const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
  return vec_make(fx_root_unit(root, v.x), fx_root_unit(root, v.y), fx_root_unit(root, v.z));
}

static int32_t minor_of(int32_t a, int32_t b, int32_t c, int32_t d) {
  return (int32_t)fx_asr64(fx_add64(fx_mul_wide(a, d), -fx_mul_wide(b, c)), 30);
}
static vec3 cross_unit(vec3 a, vec3 b) {
  return vec_make(minor_of(a.y, a.z, b.y, b.z), minor_of(a.z, a.x, b.z, b.x), minor_of(a.x, a.y, b.x, b.y));
}

/* Some unit vector across. */
static vec3 across(vec3 unit) {
  const int along_x = fx_magnitude(unit.x) > 1u << 29;
  const vec3 axis = vec_make(along_x ? 0 : 1 << 28, along_x ? 1 << 28 : 0, 0);
  return axis_unit(vec_sub(axis, vec_scale_unit(unit, vec_dot_unit(axis, unit))), vec_make(0, 0, 1 << 30));
}

static void set_axis(int32_t axis[3], vec3 unit) {
  axis[0] = fx_round(unit.x, 30 - COARSE);
  axis[1] = fx_round(unit.y, 30 - COARSE);
  axis[2] = fx_round(unit.z, 30 - COARSE);
}

static const self_way *way_at(const fray_world *w, uint32_t i, uint32_t j) {
  return &w->ways[w->crossing[j * (uint32_t)w->params->warps + i]];
}

/* How the sheet lies at the tick's begin: from each side to the other, by some crossings of it. */
static frame frame_of(const fray_world *w) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t wefts = (uint32_t)w->params->wefts;
  const uint32_t step_i = warps / 2u / SAMPLES + 1u;
  const uint32_t step_j = wefts / 2u / SAMPLES + 1u;
  int64_t u[3] = {0, 0, 0};
  int64_t v[3] = {0, 0, 0};
  frame f = {{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}};
  for (uint32_t j = 0; j < wefts / 2u; j += step_j)
    for (uint32_t i = 0; i < warps / 2u; i += step_i) {
      const self_way *a = way_at(w, i, j);
      const self_way *b = way_at(w, warps - 1u - i, j);
      const self_way *c = way_at(w, i, wefts - 1u - j);
      const self_way *d = way_at(w, warps - 1u - i, wefts - 1u - j);
      add_way(u, a->begin, b->begin);
      add_way(u, c->begin, d->begin);
      add_way(v, a->begin, c->begin);
      add_way(v, b->begin, d->begin);
    }
  const vec3 along = axis_unit(narrowed(u), vec_make(1 << 30, 0, 0));
  const vec3 down = narrowed(v);
  const vec3 aside = axis_unit(vec_sub(down, vec_scale_unit(along, vec_dot_unit(down, along))), across(along));
  set_axis(f.axis[0], along);
  set_axis(f.axis[1], aside);
  set_axis(f.axis[2], cross_unit(along, aside));
  return f;
}

static void project(const frame *f, vec3 at, int32_t field[3]) {
  const vec3 c = vec_make(fx_asr(at.x, COARSE), fx_asr(at.y, COARSE), fx_asr(at.z, COARSE));
  for (uint32_t k = 0; k < 3; ++k)
    field[k] = fx_add(fx_add(fx_mul(c.x, f->axis[k][0]), fx_mul(c.y, f->axis[k][1])),
                      fx_mul(c.z, f->axis[k][2]));
}

static void project_all(fray_world *w, const frame *f) {
  for (uint32_t p = 0; p < w->particles; ++p) {
    project(f, w->ways[p].begin, w->fields[p].begin);
    project(f, w->ways[p].end, w->fields[p].end);
  }
}

/* From one crossing to the next, along one axis and across it; halves, for the room of differences. */
static int goes_on(const int32_t from[3], const int32_t to[3], uint32_t axis, int32_t half) {
  const int32_t on = fx_asr(to[axis], 1) - fx_asr(from[axis], 1);
  const int32_t stray = fx_asr(to[1u - axis], 1) - fx_asr(from[1u - axis], 1);
  return on >= half && on - half >= (int32_t)fx_magnitude(stray);
}
static int is_spread(const fray_world *w, uint32_t from, uint32_t to, uint32_t axis, int32_t half) {
  const self_field *a = &w->fields[w->crossing[from]];
  const self_field *b = &w->fields[w->crossing[to]];
  return goes_on(a->begin, b->begin, axis, half) && goes_on(a->end, b->end, axis, half);
}

static uint32_t is_rough(const fray_world *w, uint32_t i, uint32_t j, int32_t half) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t c = j * warps + i;
  if (world_has_yarns(w) && couple_at(w, c) != FRAY_WHOLE) return 1;
  if (i + 1u < warps && !is_spread(w, c, c + 1u, 0, half)) return 1;
  return j + 1u < (uint32_t)w->params->wefts && !is_spread(w, c, c + warps, 1, half);
}

static void sum_rough(fray_world *w) {
  const selves_params *k = w->selves;
  const uint32_t warps = (uint32_t)w->params->warps;
  const int32_t half = (k->thickness / 2 * 3 + k->slack * 5 + ROUNDING) / 2;
  for (uint32_t j = 0; j < (uint32_t)w->params->wefts; ++j) {
    uint32_t row = 0;
    for (uint32_t i = 0; i < warps; ++i) {
      row += is_rough(w, i, j, half);
      w->rough[j * warps + i] = row + (j != 0 ? w->rough[(j - 1u) * warps + i] : 0u);
    }
  }
}

/* Of the crossings before (i, j). */
static uint32_t rough_before(const fray_world *w, uint32_t i, uint32_t j) {
  return i == 0 || j == 0 ? 0 : w->rough[(j - 1u) * (uint32_t)w->params->warps + i - 1u];
}

/* Crossings of two nodes of a level, and the ones behind them, to which their segments go. */
static int is_flat(const fray_world *w, const visit *v) {
  const uint32_t i0 = (v->a.i < v->b.i ? v->a.i : v->b.i) << v->level;
  const uint32_t j0 = (v->a.j < v->b.j ? v->a.j : v->b.j) << v->level;
  uint32_t i1 = (((v->a.i > v->b.i ? v->a.i : v->b.i) + 1u) << v->level) + 1u;
  uint32_t j1 = (((v->a.j > v->b.j ? v->a.j : v->b.j) + 1u) << v->level) + 1u;
  if (i1 > (uint32_t)w->params->warps) i1 = (uint32_t)w->params->warps;
  if (j1 > (uint32_t)w->params->wefts) j1 = (uint32_t)w->params->wefts;
  return rough_before(w, i1, j1) + rough_before(w, i0, j0) == rough_before(w, i0, j1) + rough_before(w, i1, j0);
}

static tree tree_of(const fray_world *w) {
  tree t;
  uint32_t columns = (uint32_t)w->params->warps;
  uint32_t rows = (uint32_t)w->params->wefts;
  t.first[0] = 0;
  for (t.levels = 0; t.levels < SELVES_LEVELS; ++t.levels) {
    t.columns[t.levels] = columns;
    t.rows[t.levels] = rows;
    if (columns == 1 && rows == 1) break;
    if (t.levels + 1u < SELVES_LEVELS) t.first[t.levels + 1u] = t.first[t.levels] + columns * rows;
    columns = (columns + 1u) / 2u;
    rows = (rows + 1u) / 2u;
  }
  return t;
}

static void around_point(self_box *b, const self_field *f) {
  for (uint32_t k = 0; k < 3; ++k) {
    b->low[0][k] = fx_min(b->low[0][k], f->begin[k]);
    b->high[0][k] = fx_max(b->high[0][k], f->begin[k]);
    b->low[1][k] = fx_min(b->low[1][k], f->end[k]);
    b->high[1][k] = fx_max(b->high[1][k], f->end[k]);
  }
}

/* Around the two segments that begin at a crossing. */
static void box_crossing(fray_world *w, uint32_t i, uint32_t j, int32_t skin) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t c = j * warps + i;
  const uint32_t first = w->crossing[c];
  self_box *b = &w->boxes[c];
  for (uint32_t k = 0; k < 3; ++k) {
    b->low[0][k] = b->high[0][k] = w->fields[first].begin[k];
    b->low[1][k] = b->high[1][k] = w->fields[first].end[k];
  }
  if (i + 1u < warps) around_point(b, &w->fields[w->crossing[c + 1u]]);
  if (world_has_yarns(w)) {
    around_point(b, &w->fields[w->warp_at[c]]);
    if (j + 1u < (uint32_t)w->params->wefts) around_point(b, &w->fields[w->warp_at[c + warps]]);
  } else if (j + 1u < (uint32_t)w->params->wefts) {
    around_point(b, &w->fields[w->crossing[c + warps]]);
  }
  for (uint32_t n = 0; n < 2; ++n)
    for (uint32_t k = 0; k < 3; ++k) {
      b->low[n][k] -= skin;
      b->high[n][k] += skin;
    }
}

static void box_node(fray_world *w, const tree *t, uint32_t level, uint32_t i, uint32_t j) {
  const uint32_t columns = t->columns[level - 1u];
  self_box *b = &w->boxes[t->first[level] + j * t->columns[level] + i];
  *b = w->boxes[t->first[level - 1u] + 2u * j * columns + 2u * i];
  for (uint32_t n = 1; n < 4; ++n) {
    const uint32_t ci = 2u * i + n % 2u;
    const uint32_t cj = 2u * j + n / 2u;
    if (ci >= columns || cj >= t->rows[level - 1u]) continue;
    const self_box *child = &w->boxes[t->first[level - 1u] + cj * columns + ci];
    for (uint32_t k = 0; k < 3; ++k)
      for (uint32_t end = 0; end < 2; ++end) {
        b->low[end][k] = fx_min(b->low[end][k], child->low[end][k]);
        b->high[end][k] = fx_max(b->high[end][k], child->high[end][k]);
      }
  }
}

static int32_t skin_of(const fray_world *w) {
  return w->selves->thickness / 2 + w->selves->thickness / 256 + 2 * w->selves->slack + ROUNDING;
}

static void box_all(fray_world *w, const tree *t) {
  const int32_t skin = skin_of(w);
  for (uint32_t j = 0; j < t->rows[0]; ++j)
    for (uint32_t i = 0; i < t->columns[0]; ++i) box_crossing(w, i, j, skin);
  for (uint32_t level = 1; level <= t->levels; ++level)
    for (uint32_t j = 0; j < t->rows[level]; ++j)
      for (uint32_t i = 0; i < t->columns[level]; ++i) box_node(w, t, level, i, j);
}

/* One is beyond the other along an axis at begin and end, and so in between: whatever all of it moves by. */
static int is_beyond(const self_box *a, const self_box *b, uint32_t k) {
  return a->high[0][k] < b->low[0][k] && a->high[1][k] < b->low[1][k];
}
static int overlap(const self_box *a, const self_box *b) {
  for (uint32_t k = 0; k < 3; ++k)
    if (is_beyond(a, b, k) || is_beyond(b, a, k)) return 0;
  return 1;
}

/* The segment that begins at a crossing, along its weft or warp; 0 where there is none. */
static int segment_at(const fray_world *w, node at, int along_warp, self_segment *s) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t wefts = (uint32_t)w->params->wefts;
  const uint32_t c = at.j * warps + at.i;
  if (along_warp ? at.j + 1u >= wefts : at.i + 1u >= warps) return 0;
  s->row = w->row_of[along_warp ? wefts * (warps - 1u) + c : c - at.j];
  if (w->row_class[s->row] == ROW_DEAD) return 0;
  s->p[0] = w->row_i[s->row];
  s->p[1] = w->row_j[s->row];
  s->crossing[0] = c;
  s->crossing[1] = along_warp ? c + warps : c + 1u;
  return 1;
}

/* Segments that share a particle, or a crossing whose yarns hold each other: the weave is theirs. */
static int are_neighbours(const fray_world *w, const self_segment *a, const self_segment *b) {
  for (uint32_t n = 0; n < 2; ++n)
    for (uint32_t k = 0; k < 2; ++k) {
      if (a->p[n] == b->p[k]) return 1;
      if (a->crossing[n] == b->crossing[k] &&
          (!world_has_yarns(w) || couple_at(w, a->crossing[n]) != FRAY_DISCONNECTED))
        return 1;
    }
  return 0;
}

static void add_pair(fray_world *w, uint32_t a, uint32_t b) {
  const self_pair pair = {(row_id)a, (row_id)b, 0, 0};
  if (w->pair_count < w->capacity[POOL_PAIRS]) {
    w->pairs[w->pair_count++] = pair;
    ++w->work.self_pairs;
    return;
  }
  w->state->faults |= (int32_t)FRAY_FAULT_SELVES;
  selves_join(w, &pair);
}

static int is_same(const visit *v) { return v->a.i == v->b.i && v->a.j == v->b.j; }

/* Of two crossings, or of one. */
static void meet(fray_world *w, const visit *v) {
  const int32_t by = w->selves->thickness + 4 * w->selves->slack;
  self_segment of[2];
  int there[2];
  for (int n = 0; n < 2; ++n) there[n] = segment_at(w, v->b, n, &of[n]);
  for (int m = 0; m < 2; ++m) {
    self_segment first;
    if (!segment_at(w, v->a, m, &first)) continue;
    for (int n = is_same(v) ? m + 1 : 0; n < 2; ++n) {
      if (!there[n] || are_neighbours(w, &first, &of[n])) continue;
      if (!selves_ways_apart(&w->ways[first.p[0]], &w->ways[first.p[1]], &w->ways[of[n].p[0]],
                             &w->ways[of[n].p[1]], by))
        add_pair(w, first.row, of[n].row);
    }
  }
}

static node child_of(node parent, uint32_t n) {
  const node child = {2u * parent.i + n % 2u, 2u * parent.j + n / 2u};
  return child;
}

static int may_meet(const fray_world *w, const tree *t, const visit *v) {
  const self_box *boxes = w->boxes + t->first[v->level];
  const uint32_t columns = t->columns[v->level];
  if (!is_same(v) && !overlap(&boxes[v->a.j * columns + v->a.i], &boxes[v->b.j * columns + v->b.i])) return 0;
  return !is_flat(w, v);
}

/* Pairs of the children of two nodes, or of one, that may meet. */
static uint32_t push_children(const fray_world *w, const tree *t, const visit *v, uint64_t *stack, uint32_t top) {
  const uint32_t columns = t->columns[v->level - 1u];
  const uint32_t rows = t->rows[v->level - 1u];
  for (uint32_t m = 0; m < 4; ++m)
    for (uint32_t n = is_same(v) ? m : 0; n < 4; ++n) {
      const visit child = {child_of(v->a, m), child_of(v->b, n), v->level - 1u};
      if (child.a.i < columns && child.b.i < columns && child.a.j < rows && child.b.j < rows &&
          may_meet(w, t, &child))
        stack[top++] = packed(child.a, child.b, child.level);
    }
  return top;
}

/* Both nodes of a visit have four children each. */
static int find_pairs(fray_world *w, const tree *t) {
  uint64_t stack[STACK];
  const node root = {0, 0};
  uint32_t left = w->capacity[POOL_CROSSINGS] * SELVES_VISITS;
  uint32_t top = 1;
  stack[0] = packed(root, root, t->levels);
  while (top > 0) {
    const visit v = unpacked(stack[--top]);
    const uint32_t looks = v.level == 0 ? 1 : is_same(&v) ? 10 : 16;
    if (left < looks) return 0;
    left -= looks;
    w->work.self_visits += looks;
    if (v.level == 0)
      meet(w, &v);
    else
      top = push_children(w, t, &v, stack, top);
  }
  return 1;
}

int selves_find(fray_world *w) {
  const frame f = frame_of(w);
  const tree t = tree_of(w);
  w->pair_count = 0;
  project_all(w, &f);
  sum_rough(w);
  if (rough_before(w, (uint32_t)w->params->warps, (uint32_t)w->params->wefts) == 0) return 1;
  box_all(w, &t);
  return find_pairs(w, &t);
}
