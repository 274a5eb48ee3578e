/* SPDX-License-Identifier: Apache-2.0 */
/* Broad phase of yarn self-collision: which segments may collide in a tick, from where all particles
 * begin and end.
 *
 * The cloth is a grid. Two structures use that, in axes u along its wefts, v along its warps and n
 * across, as the cloth lies as a whole:
 *
 * - A tree over the grid: boxes around the crossings of a node and their segments, at the start of the
 *   tick and at its end. Two nodes cannot collide if one is beyond the other along an axis at both
 *   times.
 * - Flat rectangles of the grid: every link along a weft advances along u by more than it strays along
 *   v, and every link along a warp the other way round, at the start of the tick and at its end, and so
 *   in between. In the plane of u and v such a rectangle is spread out as the grid is: of two segments
 *   that share no crossing one is beyond the other, or on one side of the line through it, by at least
 *   the weakest link's advance over root 2. So no two of them collide, however the cloth is curved
 *   across. Sums of rough crossings over all rectangles from the corner tell of any rectangle at once
 *   whether it is flat.
 *
 * So cloth that hangs in pleats costs one test at the root; only what is torn or folded is searched
 * further. Both hold for ends anywhere within the slack. */
#include "rt/self_collision/yarn_collision.h"
#include "rt/state/crossing.h"

enum {
  COARSE_BITS = 10,   /* bits of axes, and bits that coordinates along them are coarser than positions */
  ROUNDING = 1 << 13, /* bound of the rounding of a difference of two such coordinates */
  SAMPLES = 8         /* crossings along each side of a quarter of the cloth that tell how it lies */
};

/* The cloth's own axes u, v, n. */
typedef struct {
  vec3 axis[3]; /* Q10 */
} cloth_axes;

/* Levels of the tree: level 0 has a node for each crossing. */
typedef struct {
  uint32_t levels;
  uint32_t first[SELF_LEVELS], columns[SELF_LEVELS], rows[SELF_LEVELS];
} tree;

/* A node of a level, by column and row; two nodes to be tested against each other, or one against itself. */
typedef struct {
  uint32_t i, j;
} node;
typedef struct {
  node a, b;
  uint32_t level;
} node_pair;

/* Unit vector, Q30; `otherwise` where v has no direction. */
static vec3 axis_unit(vec3 v, vec3 otherwise) {
  return vec_squared(v) < 1u << 16 ? otherwise : vec_unit(v, otherwise);
}

/* Some unit vector at a right angle to this one. */
static vec3 perpendicular(vec3 unit) {
  const int along_x = fx_magnitude(unit.x) > 1u << 29;
  const vec3 axis = vec_make(along_x ? 0 : 1 << 28, along_x ? 1 << 28 : 0, 0);
  return axis_unit(vec_sub(axis, vec_scale_unit(unit, vec_dot_unit(axis, unit))), vec_make(0, 0, 1 << 30));
}

static const self_path *path_at(const fray_world *w, uint32_t i, uint32_t j) {
  return &w->self.paths[w->woven.crossing_particle[j * (uint32_t)w->params->warps + i]];
}

/* How the cloth lies at the start of the tick: from each edge to the opposite one, by some of its
 * crossings. */
static cloth_axes axes_of(const fray_world *w) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t wefts = (uint32_t)w->params->wefts;
  const uint32_t step_i = warps / 2u / SAMPLES + 1u;
  const uint32_t step_j = wefts / 2u / SAMPLES + 1u;
  vec64 u = {0, 0, 0};
  vec64 v = {0, 0, 0};
  for (uint32_t j = 0; j < wefts / 2u; j += step_j)
    for (uint32_t i = 0; i < warps / 2u; i += step_i) {
      const self_path *a = path_at(w, i, j);
      const self_path *b = path_at(w, warps - 1u - i, j);
      const self_path *c = path_at(w, i, wefts - 1u - j);
      const self_path *d = path_at(w, warps - 1u - i, wefts - 1u - j);
      u = vec_add64(u, vec_add64(vec_sub64(b->begin, a->begin), vec_sub64(d->begin, c->begin)));
      v = vec_add64(v, vec_add64(vec_sub64(c->begin, a->begin), vec_sub64(d->begin, b->begin)));
    }
  const vec3 u_axis = axis_unit(vec_narrow64(u, 28), vec_make(1 << 30, 0, 0));
  const vec3 v_about = vec_narrow64(v, 28);
  const vec3 v_along_u = vec_scale_unit(u_axis, vec_dot_unit(v_about, u_axis));
  const vec3 v_axis = axis_unit(vec_sub(v_about, v_along_u), perpendicular(u_axis));
  const unsigned coarser = 30 - COARSE_BITS;
  const cloth_axes axes = {{vec_round(u_axis, coarser), vec_round(v_axis, coarser),
                            vec_round(vec_cross_unit(u_axis, v_axis), coarser)}};
  return axes;
}

static vec3 to_axes(const cloth_axes *axes, vec3 at) {
  const vec3 c = vec_asr(at, COARSE_BITS);
  return vec_make(vec_dot(c, axes->axis[0]), vec_dot(c, axes->axis[1]), vec_dot(c, axes->axis[2]));
}

static void paths_to_axes(fray_world *w, const cloth_axes *axes) {
  for (uint32_t p = 0; p < w->p.count; ++p) {
    w->yarn.grid_paths[p].begin = to_axes(axes, w->self.paths[p].begin);
    w->yarn.grid_paths[p].end = to_axes(axes, w->self.paths[p].end);
  }
}

/* From one crossing to the next along one axis, by more than it strays along the other and half_min.
 * Halves of coordinates, so that differences fit. */
static int advances(vec3 from, vec3 to, uint32_t axis, int32_t half_min) {
  const vec3 half = vec_sub(vec_asr(to, 1), vec_asr(from, 1));
  const int32_t on = axis == 0 ? half.x : half.y;
  const int32_t stray = axis == 0 ? half.y : half.x;
  return on >= half_min && on - half_min >= (int32_t)fx_magnitude(stray);
}
static int link_is_flat(const fray_world *w, uint32_t from, uint32_t to, uint32_t axis, int32_t half_min) {
  const self_grid_path *a = &w->yarn.grid_paths[w->woven.crossing_particle[from]];
  const self_grid_path *b = &w->yarn.grid_paths[w->woven.crossing_particle[to]];
  return advances(a->begin, b->begin, axis, half_min) && advances(a->end, b->end, axis, half_min);
}

/* A crossing that is split, or from which a link does not advance as in a flat rectangle. */
static uint32_t is_rough(const fray_world *w, uint32_t i, uint32_t j, int32_t half_min) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t c = j * warps + i;
  if (world_has_yarns(w) && crossing_state_at(w, c) != FRAY_WHOLE) return 1;
  if (i + 1u < warps && !link_is_flat(w, c, c + 1u, 0, half_min)) return 1;
  return j + 1u < (uint32_t)w->params->wefts && !link_is_flat(w, c, c + warps, 1, half_min);
}

static void sum_rough(fray_world *w) {
  const self_params *k = w->self.constants;
  const uint32_t warps = (uint32_t)w->params->warps;
  const int32_t half_min = (k->thickness / 2 * 3 + k->slack * 5 + ROUNDING) / 2;
  for (uint32_t j = 0; j < (uint32_t)w->params->wefts; ++j) {
    uint32_t row = 0;
    for (uint32_t i = 0; i < warps; ++i) {
      row += is_rough(w, i, j, half_min);
      w->yarn.rough_before[j * warps + i] = row + (j != 0 ? w->yarn.rough_before[(j - 1u) * warps + i] : 0u);
    }
  }
}

/* Rough crossings in columns below i and rows below j. */
static uint32_t rough_before(const fray_world *w, uint32_t i, uint32_t j) {
  FRAY_ASSERT(i <= (uint32_t)w->params->warps && j <= (uint32_t)w->params->wefts);
  return i == 0 || j == 0 ? 0 : w->yarn.rough_before[(j - 1u) * (uint32_t)w->params->warps + i - 1u];
}

/* The rectangle around two nodes, with the crossings at which their segments end, is flat. */
static int are_flat(const fray_world *w, const node_pair *v) {
  const uint32_t i0 = (v->a.i < v->b.i ? v->a.i : v->b.i) << v->level;
  const uint32_t j0 = (v->a.j < v->b.j ? v->a.j : v->b.j) << v->level;
  uint32_t i1 = (((v->a.i > v->b.i ? v->a.i : v->b.i) + 1u) << v->level) + 1u;
  uint32_t j1 = (((v->a.j > v->b.j ? v->a.j : v->b.j) + 1u) << v->level) + 1u;
  if (i1 > (uint32_t)w->params->warps) i1 = (uint32_t)w->params->warps;
  if (j1 > (uint32_t)w->params->wefts) j1 = (uint32_t)w->params->wefts;
  return rough_before(w, i1, j1) + rough_before(w, i0, j0) ==
         rough_before(w, i0, j1) + rough_before(w, i1, j0);
}

static tree tree_of(const fray_world *w) {
  tree t;
  uint32_t columns = (uint32_t)w->params->warps;
  uint32_t rows = (uint32_t)w->params->wefts;
  t.first[0] = 0;
  for (t.levels = 0; t.levels < SELF_LEVELS; ++t.levels) {
    t.columns[t.levels] = columns;
    t.rows[t.levels] = rows;
    if (columns == 1 && rows == 1) break;
    if (t.levels + 1u < SELF_LEVELS) t.first[t.levels + 1u] = t.first[t.levels] + columns * rows;
    columns = (columns + 1u) / 2u;
    rows = (rows + 1u) / 2u;
  }
  FRAY_ASSERT(t.levels < SELF_LEVELS);
  return t;
}

static void include_box(self_box *b, const self_box *other) {
  for (uint32_t end = 0; end < 2; ++end) {
    b->low[end] = vec_min(b->low[end], other->low[end]);
    b->high[end] = vec_max(b->high[end], other->high[end]);
  }
}
static self_box box_of(const self_grid_path *path) {
  const self_box b = {{path->begin, path->end}, {path->begin, path->end}};
  return b;
}
static void include_point(self_box *b, const self_grid_path *path) {
  const self_box point = box_of(path);
  include_box(b, &point);
}

/* Around the two segments that begin at a crossing. */
static void set_crossing_box(fray_world *w, uint32_t i, uint32_t j, int32_t margin) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t c = j * warps + i;
  const vec3 margins = vec_make(margin, margin, margin);
  self_box *b = &w->yarn.boxes[c];
  *b = box_of(&w->yarn.grid_paths[w->woven.crossing_particle[c]]);
  if (i + 1u < warps) include_point(b, &w->yarn.grid_paths[w->woven.crossing_particle[c + 1u]]);
  if (world_has_yarns(w)) {
    include_point(b, &w->yarn.grid_paths[w->woven.warp_particle[c]]);
    if (j + 1u < (uint32_t)w->params->wefts)
      include_point(b, &w->yarn.grid_paths[w->woven.warp_particle[c + warps]]);
  } else if (j + 1u < (uint32_t)w->params->wefts) {
    include_point(b, &w->yarn.grid_paths[w->woven.crossing_particle[c + warps]]);
  }
  for (uint32_t end = 0; end < 2; ++end) {
    b->low[end] = vec_sub(b->low[end], margins);
    b->high[end] = vec_add(b->high[end], margins);
  }
}

static void set_node_box(fray_world *w, const tree *t, uint32_t level, uint32_t i, uint32_t j) {
  const uint32_t columns = t->columns[level - 1u];
  self_box *b = &w->yarn.boxes[t->first[level] + j * t->columns[level] + i];
  *b = w->yarn.boxes[t->first[level - 1u] + 2u * j * columns + 2u * i];
  for (uint32_t n = 1; n < 4; ++n) {
    const uint32_t ci = 2u * i + n % 2u;
    const uint32_t cj = 2u * j + n / 2u;
    if (ci >= columns || cj >= t->rows[level - 1u]) continue;
    include_box(b, &w->yarn.boxes[t->first[level - 1u] + cj * columns + ci]);
  }
}

static int32_t box_margin(const fray_world *w) {
  const self_params *k = w->self.constants;
  return k->thickness / 2 + k->thickness / 256 + 2 * k->slack + ROUNDING;
}

static void set_boxes(fray_world *w, const tree *t) {
  const int32_t margin = box_margin(w);
  for (uint32_t j = 0; j < t->rows[0]; ++j)
    for (uint32_t i = 0; i < t->columns[0]; ++i) set_crossing_box(w, i, j, margin);
  for (uint32_t level = 1; level <= t->levels; ++level)
    for (uint32_t j = 0; j < t->rows[level]; ++j)
      for (uint32_t i = 0; i < t->columns[level]; ++i) set_node_box(w, t, level, i, j);
}

/* One is beyond the other along an axis at the start and at the end, and so, as paths are straight, in
 * between. */
static int box_is_beyond(const self_box *a, const self_box *b) {
  return (a->high[0].x < b->low[0].x && a->high[1].x < b->low[1].x) ||
         (a->high[0].y < b->low[0].y && a->high[1].y < b->low[1].y) ||
         (a->high[0].z < b->low[0].z && a->high[1].z < b->low[1].z);
}

/* The segment that begins at a crossing, along its weft or warp; 0 where there is none. */
static int segment_at(const fray_world *w, node at, int along_warp, yarn_segment *s) {
  FRAY_ASSERT(at.i < (uint32_t)w->params->warps && at.j < (uint32_t)w->params->wefts);
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t wefts = (uint32_t)w->params->wefts;
  const uint32_t c = at.j * warps + at.i;
  if (along_warp ? at.j + 1u >= wefts : at.i + 1u >= warps) return 0;
  s->spring = w->woven.spring_of[along_warp ? wefts * (warps - 1u) + c : c - at.j];
  if (w->woven.spring_kind[s->spring] == SPRING_DEAD) return 0;
  s->p[0] = w->woven.spring_i[s->spring];
  s->p[1] = w->woven.spring_j[s->spring];
  s->crossing[0] = c;
  s->crossing[1] = along_warp ? c + warps : c + 1u;
  return 1;
}

static int is_along_warp(const yarn_segment *s) { return s->crossing[1] - s->crossing[0] != 1u; }

/* The contact of the two yarns, a weft's and a warp's segment, is on both or on those next to them. */
static int contact_is_near(const fray_world *w, const yarn_segment *weft, const yarn_segment *warp) {
  const uint32_t warps = (uint32_t)w->params->warps;
  const uint32_t c = weft->crossing[0] / warps * warps + warp->crossing[0] % warps;
  if (crossing_state_at(w, c) == FRAY_WHOLE || crossing_state_at(w, c) == FRAY_DISCONNECTED) return 0;
  const yarn_contact *k = &w->woven.contacts[crossing_contact(w, c)];
  const uint32_t end[2] = {weft->crossing[0] % warps + 1u, warp->crossing[0] / warps + 1u};
  for (uint32_t axis = 0; axis < 2; ++axis)
    if (yarn_places_apart(k->place[axis], end[axis] << YARN_PLACE_BITS) > 3u * (uint32_t)YARN_PLACE_HALF)
      return 0;
  return 1;
}

/* Segments that share a particle, or a crossing that holds its yarns together, are the weave's own. */
static int are_woven_together(const fray_world *w, const yarn_segment *a, const yarn_segment *b) {
  for (uint32_t n = 0; n < 2; ++n)
    for (uint32_t k = 0; k < 2; ++k) {
      if (a->p[n] == b->p[k]) return 1;
      if (a->crossing[n] == b->crossing[k] &&
          (!world_has_yarns(w) || crossing_state_at(w, a->crossing[n]) != FRAY_DISCONNECTED))
        return 1;
    }
  if (!world_has_yarns(w) || is_along_warp(a) == is_along_warp(b)) return 0;
  return is_along_warp(a) ? contact_is_near(w, b, a) : contact_is_near(w, a, b);
}

static void meet_bound(fray_world *w) {
  world_fault(w, FRAY_FAULT_SELF_COLLISION_BUDGET);
  w->yarn.bound_met = 1;
}

/* What has no room is pushed at once, in the first pass, and merged only where it touches; of so many a tick,
 * others are left out. What may touch later by that is found in another pass. */
static void push_without_room(fray_world *w, self_pair *pair) {
  meet_bound(w);
  if (w->yarn.without_room == w->capacity[POOL_CROSSINGS] * SELF_WITHOUT_ROOM) return;
  ++w->yarn.without_room;
  if (w->yarn.pass == 0 && yarn_collision_push(w, pair)) w->yarn.moved_without_room = 1;
  if (!yarn_collision_touches(w, pair)) return;
  yarn_collision_merge(w, pair);
  w->yarn.moved_without_room = 1;
}

static void add_pair(fray_world *w, uint32_t a, uint32_t b) {
  self_pair pair = {(index_t)a, (index_t)b, 0, 0};
  if (w->yarn.pair_count == w->capacity[POOL_YARN_PAIRS]) {
    push_without_room(w, &pair);
    return;
  }
  w->yarn.pairs[w->yarn.pair_count++] = pair;
  ++w->work.self_pairs;
}

static int is_one_node(const node_pair *v) { return v->a.i == v->b.i && v->a.j == v->b.j; }

/* The segments that begin at two crossings, or at one. */
static void test_crossings(fray_world *w, const node_pair *v) {
  const int32_t distance = w->self.constants->thickness + 4 * w->self.constants->slack;
  yarn_segment second[2];
  int exists[2];
  for (int n = 0; n < 2; ++n) exists[n] = segment_at(w, v->b, n, &second[n]);
  for (int m = 0; m < 2; ++m) {
    yarn_segment first;
    if (!segment_at(w, v->a, m, &first)) continue;
    for (int n = is_one_node(v) ? m + 1 : 0; n < 2; ++n) {
      const self_path *path = w->self.paths;
      if (!exists[n] || are_woven_together(w, &first, &second[n])) continue;
      if (!yarn_collision_paths_apart(&path[first.p[0]], &path[first.p[1]], &path[second[n].p[0]],
                                      &path[second[n].p[1]], distance))
        add_pair(w, first.spring, second[n].spring);
    }
  }
}

static node child_of(node parent, uint32_t n) {
  const node child = {2u * parent.i + n % 2u, 2u * parent.j + n / 2u};
  return child;
}

static int may_collide(const fray_world *w, const tree *t, const node_pair *v) {
  const self_box *boxes = w->yarn.boxes + t->first[v->level];
  const uint32_t columns = t->columns[v->level];
  const self_box *a = &boxes[v->a.j * columns + v->a.i];
  const self_box *b = &boxes[v->b.j * columns + v->b.i];
  return (is_one_node(v) || (!box_is_beyond(a, b) && !box_is_beyond(b, a))) && !are_flat(w, v);
}

/* A pair of nodes on the way down, and how many pairs of their children were not visited yet. */
typedef struct {
  node_pair pair;
  uint32_t left;
} visit;

/* The next pair of children that may collide. Returns 0 iff none is left. */
static int next_children(const fray_world *w, const tree *t, visit *v, node_pair *children) {
  const uint32_t turn = (uint32_t)state_tick(w->state) % 4u; /* so a bound leaves out others each tick */
  const uint32_t level = v->pair.level - 1u;
  while (v->left > 0) {
    --v->left;
    const uint32_t m = v->left / 4u;
    const uint32_t n = v->left % 4u;
    if (is_one_node(&v->pair) && n < m) continue;
    const node_pair next = {child_of(v->pair.a, m ^ turn), child_of(v->pair.b, n ^ turn), level};
    if (next.a.i >= t->columns[level] || next.b.i >= t->columns[level] || next.a.j >= t->rows[level] ||
        next.b.j >= t->rows[level] || !may_collide(w, t, &next))
      continue;
    *children = next;
    return 1;
  }
  return 0;
}

/* Returns 0 iff the budget is used up. */
static int take_tests(fray_world *w, const node_pair *v, uint32_t *left) {
  const uint32_t tests = v->level == 0 ? 1 : is_one_node(v) ? 10 : 16;
  if (*left < tests) return 0;
  *left -= tests;
  w->work.self_box_tests += tests;
  return 1;
}

/* Descends both nodes of a pair at once: 10 or 16 pairs of children each. Where the budget of tests is used
 * up, the rest is left out in this tick. */
static void find_pairs(fray_world *w, const tree *t) {
  visit way[SELF_LEVELS]; /* from the root, a pair a level */
  const node root = {0, 0};
  const visit whole = {{root, root, t->levels}, 16};
  uint32_t left = w->capacity[POOL_CROSSINGS] * SELF_VISITS;
  uint32_t length = 1;
  way[0] = whole;
  FRAY_ASSERT(t->levels < (uint32_t)SELF_LEVELS);
  if (!take_tests(w, &whole.pair, &left)) {
    meet_bound(w);
    return;
  }
  while (length > 0) {
    visit *v = &way[length - 1u];
    visit down = {{root, root, 0}, 16};
    if (v->pair.level == 0) test_crossings(w, &v->pair);
    if (v->pair.level == 0 || !next_children(w, t, v, &down.pair)) {
      --length;
      continue;
    }
    if (!take_tests(w, &down.pair, &left)) {
      meet_bound(w);
      return;
    }
    way[length++] = down;
  }
}

void yarn_collision_find(fray_world *w) {
  const cloth_axes axes = axes_of(w);
  const tree t = tree_of(w);
  w->yarn.pair_count = 0;
  w->yarn.moved_without_room = 0;
  paths_to_axes(w, &axes);
  sum_rough(w);
  if (rough_before(w, (uint32_t)w->params->warps, (uint32_t)w->params->wefts) == 0) return;
  set_boxes(w, &t);
  find_pairs(w, &t);
  FRAY_ASSERT(w->yarn.pair_count <= w->capacity[POOL_YARN_PAIRS]);
}
