/* SPDX-License-Identifier: Apache-2.0 */
/* Narrow phase of triangle self-collision: which features (vertex and triangle, edge and edge) of two
 * near triangles may collide, now or later. Every test is conservative: it may keep a pair that cannot
 * collide, never the reverse. */
#include "rt/self_collision/patches.h"
#include "rt/self_collision/triangle_collision.h"

/* ---- two features ---- */

/* How far a vertex of the second moves relative to one of the first in this tick, at most. */
static int64_t relative_travel(const fray_world *w, const triangle_pair *pair) {
  const uint32_t firsts = triangle_pair_firsts(pair);
  int32_t farthest = 0;
  for (uint32_t m = 0; m < firsts; ++m)
    for (uint32_t n = firsts; n < 4; ++n) {
      const self_path *a = &w->self.paths[pair->p[m]];
      const self_path *b = &w->self.paths[pair->p[n]];
      farthest = fx_max(farthest, patches_travel(b->begin, b->end, vec_sub(a->end, a->begin)));
    }
  return farthest;
}

/* They may collide in this tick: they begin within their relative travel, and the direction of the gap
 * at the start does not separate them at the end. */
static int may_collide(const fray_world *w, const triangle_pair *pair, ccd_gap gap) {
  const int64_t distance = patches_distance_min(w);
  return (gap.begin <= distance || gap.end <= distance) && gap.begin <= distance + relative_travel(w, pair);
}

static int is_same_at_rest(const trimesh *s, uint32_t p, uint32_t q) {
  return s->u[p] == s->u[q] && s->v[p] == s->v[q];
}

/* Two vertices that a tear has made from one, and that are within the thickness of each other still. */
static int is_still_one_vertex(const fray_world *w, uint32_t p, uint32_t q) {
  const vec3 d = vec_sub(w->self.paths[p].begin, w->self.paths[q].begin);
  return is_same_at_rest(&w->trimesh, p, q) && vec_is_within(d, w->self.constants->thickness);
}

static int has_one_vertex(const fray_world *w, const triangle_pair *pair) {
  const uint32_t firsts = triangle_pair_firsts(pair);
  for (uint32_t m = 0; m < firsts && pair->was_one_vertex != 0; ++m)
    for (uint32_t n = firsts; n < 4; ++n)
      if (is_still_one_vertex(w, pair->p[m], pair->p[n])) return 1;
  return 0;
}

static uint8_t had_one_vertex(const trimesh *s, const triangle_pair *pair) {
  const uint32_t firsts = triangle_pair_firsts(pair);
  for (uint32_t m = 0; m < firsts; ++m)
    for (uint32_t n = firsts; n < 4; ++n)
      if (is_same_at_rest(s, pair->p[m], pair->p[n])) return 1;
  return 0;
}

/* From a + b to c + d, over 64. */
static vec3 between_edges(vec3 a, vec3 b, vec3 c, vec3 d) {
  return vec_sub(vec_add(vec_asr(c, 6), vec_asr(d, 6)), vec_add(vec_asr(a, 6), vec_asr(b, 6)));
}
/* a + b + c, over 32. */
static vec3 sum_of_corners(vec3 a, vec3 b, vec3 c) {
  return vec_add(vec_add(vec_asr(a, 5), vec_asr(b, 5)), vec_asr(c, 5));
}

/* The direction between their centres separates them by more than `reach` when the tick begins; and, if
 * `whole_tick`, when it ends. */
static int are_separated(const fray_world *w, const triangle_pair *pair, int64_t reach, int whole_tick) {
  const uint32_t firsts = triangle_pair_firsts(pair);
  const self_path *path[4];
  for (uint32_t n = 0; n < 4; ++n) path[n] = &w->self.paths[pair->p[n]];
  const vec3 p = path[0]->begin;
  const vec3 q = path[1]->begin;
  const vec3 r = path[2]->begin;
  const vec3 s = path[3]->begin;

  /* components in 29 bits */
  const vec3 along = firsts == 2 ? between_edges(p, q, r, s)
                                 : vec_sub(sum_of_corners(q, r, s), vec_mul(vec_asr(p, 5), 3));
  const int64_t margin = fx_mul_wide(collision_pair_length(along), fx_saturate(reach));

  /* the first's farthest projection at the start and at the end */
  int64_t first[2] = {margin, margin};
  if (firsts == 2) {
    const int64_t begin = collision_pair_project(p, q, along);
    const int64_t end = collision_pair_project(path[0]->end, path[1]->end, along);
    if (begin > 0) first[0] = fx_add64(first[0], begin);
    if (end > 0) first[1] = fx_add64(first[1], end);
  }
  for (uint32_t n = firsts; n < 4; ++n)
    if (collision_pair_project(p, path[n]->begin, along) <= first[0] ||
        (whole_tick && collision_pair_project(path[0]->end, path[n]->end, along) <= first[1]))
      return 0;
  return 1;
}

/* The same of one of the axes, when the tick begins and when it ends. */
static int an_axis_separates(const fray_world *w, const triangle_pair *pair, int64_t reach) {
  const uint32_t firsts = triangle_pair_firsts(pair);
  int32_t apart[6] = {INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX, INT32_MAX};
  for (uint32_t m = 0; m < firsts; ++m)
    for (uint32_t n = firsts; n < 4; ++n) {
      const self_path *a = &w->self.paths[pair->p[m]];
      const self_path *b = &w->self.paths[pair->p[n]];
      const vec3 begin = vec_sub(b->begin, a->begin);
      const vec3 end = vec_sub(b->end, a->end);
      const int32_t from[3] = {begin.x, begin.y, begin.z};
      const int32_t to[3] = {end.x, end.y, end.z};
      for (uint32_t k = 0; k < 3; ++k) {
        apart[k] = fx_min(apart[k], fx_min(from[k], to[k]));
        apart[3 + k] = fx_min(apart[3 + k], -fx_max(from[k], to[k]));
      }
    }
  for (uint32_t k = 0; k < 6; ++k)
    if (apart[k] > reach) return 1;
  return 0;
}

/* ---- two triangles ---- */

typedef struct {
  uint32_t triangle[2]; /* the greater number first */
  const index_t *v[2];
  vec3 at[2][3];        /* when the tick begins */
  uint32_t common[3];   /* of each corner of the first: bit k iff corner k of the second is the same vertex */
  int32_t reach;
  int is_for_tick;      /* pairs are listed for this tick alone */
  int32_t apart;        /* then, farther than that all the time is far enough; else the reach, at its begin */
} triangle_test;

/* Returns the corners of the second that are the first's too, a bit each. */
static uint32_t begin_test(const fray_world *w, uint32_t t, uint32_t other, triangle_test *d) {
  uint32_t common = 0;
  d->triangle[0] = t > other ? t : other;
  d->triangle[1] = t > other ? other : t;
  for (uint32_t n = 0; n < 2; ++n) {
    d->v[n] = w->trimesh.triangle[d->triangle[n]].v;
    for (uint32_t k = 0; k < 3; ++k) d->at[n][k] = w->self.paths[d->v[n][k]].begin;
  }
  for (uint32_t k = 0; k < 3; ++k) {
    const index_t p = d->v[0][k];
    d->common[k] = (p == d->v[1][0] ? 1u : 0u) | (p == d->v[1][1] ? 2u : 0u) | (p == d->v[1][2] ? 4u : 0u);
    common |= d->common[k];
  }
  return common;
}

/* Along an axis, two boxes are farther apart than `reach`. */
static int boxes_are_apart(vec3 low, vec3 high, vec3 other_low, vec3 other_high, int32_t reach) {
  const vec3 after = vec_sub(other_low, high);
  const vec3 before = vec_sub(low, other_high);
  return after.x > reach || before.x > reach || after.y > reach || before.y > reach || after.z > reach ||
         before.z > reach;
}

/* Edge m of the first and edge n of the second. */
static int edge_boxes_are_apart(const triangle_test *d, uint32_t m, uint32_t n) {
  const vec3 p = d->at[0][trimesh_next(m)];
  const vec3 q = d->at[0][trimesh_previous(m)];
  const vec3 r = d->at[1][trimesh_next(n)];
  const vec3 s = d->at[1][trimesh_previous(n)];
  return boxes_are_apart(vec_min(p, q), vec_max(p, q), vec_min(r, s), vec_max(r, s), d->reach);
}
/* Corner k of triangle `which` and the other triangle. */
static int corner_box_is_apart(const triangle_test *d, uint32_t which, uint32_t k) {
  const vec3 p = d->at[which][k];
  const vec3 *t = d->at[1u - which];
  return boxes_are_apart(p, p, vec_min(vec_min(t[0], t[1]), t[2]), vec_max(vec_max(t[0], t[1]), t[2]),
                         d->reach);
}

/* Each corner of b is farther along than each of a, by more than `margin`. */
static int is_beyond(const vec3 a[3], const vec3 b[3], vec3 along, int64_t margin) {
  int64_t first = 0;
  for (uint32_t n = 1; n < 3; ++n) {
    const int64_t at = collision_pair_project(a[0], a[n], along);
    if (at > first) first = at;
  }
  first += margin;
  return collision_pair_project(a[0], b[0], along) > first &&
         collision_pair_project(a[0], b[1], along) > first &&
         collision_pair_project(a[0], b[2], along) > first;
}

/* The direction between their centres separates the triangles, and so all of their features, by more than
 * `apart` when the tick begins; and, if `whole_tick`, when it ends. */
static int triangles_are_separated(const fray_world *w, const triangle_test *d, int32_t apart,
                                   int whole_tick) {
  const vec3 *a = d->at[0];
  const vec3 *b = d->at[1];
  const vec3 along = vec_sub(sum_of_corners(b[0], b[1], b[2]), sum_of_corners(a[0], a[1], a[2]));
  const int64_t margin = fx_mul_wide(collision_pair_length(along), apart);
  vec3 end[2][3];
  if (!is_beyond(a, b, along, margin)) return 0;
  if (!whole_tick) return 1;
  for (uint32_t n = 0; n < 2; ++n)
    for (uint32_t k = 0; k < 3; ++k) end[n][k] = w->self.paths[d->v[n][k]].end;
  return is_beyond(end[0], end[1], along, margin);
}

/* ---- the list ---- */

/* Travel of both triangles, and of their patches, since they were listed. */
static int64_t travelled_of(const fray_world *w, const triangle_pair *pair) {
  const uint32_t a = w->tri.boxes[pair->triangle[0]].patch;
  const uint32_t b = w->tri.boxes[pair->triangle[1]].patch;
  return (int64_t)w->tri.travel[pair->triangle[0]].travelled + w->tri.travel[pair->triangle[1]].travelled +
         (a == b ? 0 : patches_pair(w, a, b)->travelled);
}

/* What the search may leave out by a box or a direction of whole triangles is no pair of this tick, listed or
 * not: so what an earlier tick has listed makes no difference. */
static int triangles_stay_apart(const fray_world *w, const triangle_pair *pair) {
  triangle_test d;
  return begin_test(w, pair->triangle[0], pair->triangle[1], &d) == 0 &&
         triangles_are_separated(w, &d, fx_saturate(patches_distance_min(w)), 1);
}

static void check_listed(fray_world *w, uint32_t n, ccd_gap gap) {
  triangle_pair *pair = &w->tri.pairs[n];
  FRAY_ASSERT(n < w->tri.list->pairs && w->tri.list->active < w->capacity[POOL_TRIANGLE_PAIRS]);
  const int64_t distance = patches_distance_min(w);
  pair->recheck_at = fx_saturate((int64_t)gap.begin - distance - travelled_of(w, pair));
  if (!may_collide(w, pair, gap) || are_separated(w, pair, distance, 1) ||
      an_axis_separates(w, pair, distance) || triangles_stay_apart(w, pair) || has_one_vertex(w, pair))
    return;
  pair->tested_round = pair->near = 0;
  w->tri.active[w->tri.list->active++] = n;
}

void triangle_collision_check(fray_world *w, uint32_t n) {
  check_listed(w, n, triangle_collision_gap(w, &w->tri.pairs[n]));
}

/* What has no room is merged where it touches; of so many a tick, others are left out. */
static void merge_without_room(fray_world *w, const triangle_pair *pair) {
  triangle_pair_list *l = w->tri.list;
  if (l->without_room >= triangles_in_use(w) * SELF_TRIANGLES_WITHOUT_ROOM) return;
  ++l->without_room;
  if (has_one_vertex(w, pair) || !triangle_collision_touches(w, pair)) return;
  triangle_collision_merge(w, pair);
  l->merged_without_room = 1;
}

static void add_pair(fray_world *w, const triangle_test *d, triangle_pair *pair) {
  triangle_pair_list *l = w->tri.list;
  if (are_separated(w, pair, d->apart, d->is_for_tick)) return;
  const ccd_gap gap = triangle_collision_gap(w, pair);
  if (gap.begin > d->reach || (d->is_for_tick && !may_collide(w, pair, gap))) return;

  pair->was_one_vertex = had_one_vertex(&w->trimesh, pair);
  if (l->merge_rest != 0) {
    merge_without_room(w, pair);
  } else if (l->pairs < w->capacity[POOL_TRIANGLE_PAIRS]) {
    w->tri.pairs[l->pairs++] = *pair;
    check_listed(w, l->pairs - 1u, gap);
  } else {
    l->pool_short = 1;
  }
}

/* ---- listing two triangles ---- */

static void add_features(fray_world *w, const triangle_test *d, index_t p, index_t q, index_t r, index_t s,
                         uint32_t kind) {
  triangle_pair pair = {
      0, {(index_t)d->triangle[0], (index_t)d->triangle[1]}, {p, q, r, s}, (uint8_t)kind, 0, 0, 0};
  add_pair(w, d, &pair);
}

static void add_corner(fray_world *w, const triangle_test *d, uint32_t which, uint32_t k) {
  const index_t *v = d->v[1u - which];
  add_features(w, d, d->v[which][k], v[0], v[1], v[2], 3u * which + k);
}

static void add_edges(fray_world *w, const triangle_test *d, uint32_t m, uint32_t n) {
  add_features(w, d, d->v[0][trimesh_next(m)], d->v[0][trimesh_previous(m)], d->v[1][trimesh_next(n)],
               d->v[1][trimesh_previous(n)], TRIANGLE_PAIR_CORNERS + 3u * m + n);
}

/* Vertices and edges are tested with the one triangle that owns them. Features with a common vertex are
 * skipped. */
void triangle_collision_test(fray_world *w, uint32_t t, uint32_t other, int32_t reach) {
  FRAY_ASSERT(t != other && t < triangles_in_use(w) && other < triangles_in_use(w));
  triangle_test d;
  const uint32_t common = begin_test(w, t, other, &d);
  d.reach = reach;
  d.is_for_tick =
      w->tri.list->this_search_only != 0 || w->tri.boxes[t].fast != 0 || w->tri.boxes[other].fast != 0;
  d.apart = d.is_for_tick ? fx_saturate(patches_distance_min(w)) : reach;
  const uint32_t own[2] = {w->tri.boxes[d.triangle[0]].owned, w->tri.boxes[d.triangle[1]].owned};
  if (common == 0 && triangles_are_separated(w, &d, d.apart, d.is_for_tick)) return;

  for (uint32_t k = 0; k < 3; ++k) {
    const int test_first = (own[0] >> k & 1u) != 0 && d.common[k] == 0;
    const int test_second = (own[1] >> k & 1u) != 0 && (common >> k & 1u) == 0;
    if (test_first && !corner_box_is_apart(&d, 0, k)) add_corner(w, &d, 0, k);
    if (test_second && !corner_box_is_apart(&d, 1, k)) add_corner(w, &d, 1, k);
  }
  for (uint32_t m = 0; m < 3; ++m) {
    const uint32_t shared = d.common[trimesh_next(m)] | d.common[trimesh_previous(m)];
    if ((own[0] >> (3u + m) & 1u) == 0) continue;
    for (uint32_t n = 0; n < 3; ++n)
      if ((own[1] >> (3u + n) & 1u) != 0 && (shared & ~(1u << n)) == 0 && !edge_boxes_are_apart(&d, m, n))
        add_edges(w, &d, m, n);
  }
}
