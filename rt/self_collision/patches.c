/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/self_collision/patches.h"

enum { BUDGET_FRACTION = 8 }; /* default budget: that fraction of the mean width of triangles */

/* ---- travel ---- */

static int32_t length_of(vec3 v) {
  return vec_is_within(v, PATCHES_TRAVEL_MAX / 2) ? collision_pair_length(v) : PATCHES_TOO_FAR;
}

int32_t patches_travel(vec3 from, vec3 to, vec3 mean) {
  const vec64 less_mean = vec_sub64(vec_make(0, 0, 0), mean);
  return length_of(vec_clamp64(vec_add64(vec_sub64(to, from), less_mean), INT32_MAX));
}

/* The mean path of its triangles' corners in this tick. */
static vec3 mean_path(const fray_world *w, const triangle_patch *patch) {
  vec64 sum = {0, 0, 0};
  const int64_t count = 3 * ((int64_t)patch->end - patch->first);
  for (uint32_t n = patch->first; n < patch->end; ++n)
    for (uint32_t k = 0; k < 3; ++k) {
      const self_path *path = &w->self.paths[w->tri.boxes[w->tri.order[n]].v[k]];
      sum = vec_add64(sum, vec_sub64(path->end, path->begin));
    }
  if (count == 0) return vec_make(0, 0, 0);
  return vec_make((int32_t)(sum.x / count), (int32_t)(sum.y / count), (int32_t)(sum.z / count));
}

/* Travel of a triangle in this tick. */
static int32_t tick_travel(const fray_world *w, uint32_t t) {
  const triangle_box *b = &w->tri.boxes[t];
  const vec3 mean = w->tri.patches[b->patch].mean;
  int32_t farthest = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    const self_path *path = &w->self.paths[b->v[k]];
    farthest = fx_max(farthest, patches_travel(path->begin, path->end, mean));
  }
  return farthest;
}

/* Where a corner would be if its patch had not moved since the list was emptied. Sums of travel wrap; only
 * their differences are used. */
static vec3 corner_of(const fray_world *w, uint32_t t, uint32_t k) {
  FRAY_ASSERT(t < triangles_in_use(w) && k < 3);
  const triangle_box *b = &w->tri.boxes[t];
  return vec_wrap_sub(w->self.paths[b->v[k]].begin, w->tri.patches[b->patch].travelled);
}

/* Travel of a triangle since it was listed. */
static int32_t travel_since(const fray_world *w, uint32_t t) {
  int32_t farthest = 0;
  for (uint32_t k = 0; k < 3; ++k)
    farthest = fx_max(farthest, length_of(vec_wrap_sub(corner_of(w, t, k), w->tri.travel[t].from[k])));
  return farthest;
}

void patches_advance(fray_world *w) {
  FRAY_ASSERT(patches_count(w) <= PATCHES_MAX);
  triangle_patch *patch = w->tri.patches;
  if (w->tri.list->valid == 0) return;
  for (uint32_t a = 0; a < patches_count(w); ++a) {
    patch[a].travelled = vec_wrap_add(patch[a].travelled, patch[a].mean);
    patch[a].mean = vec_make(0, 0, 0);
  }
}

/* ---- boxes ---- */

static uint8_t owned_by(const fray_world *w, uint32_t t) {
  const trimesh_triangle *f = &w->trimesh.triangle[t];
  uint32_t owned = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    if (w->trimesh.first_triangle[f->v[k]] == t) owned |= 1u << k;
    if (f->neighbour[k] >= t) owned |= 8u << k;
  }
  return (uint8_t)owned;
}

static void set_box(fray_world *w, uint32_t t, int32_t margin) {
  triangle_box *b = &w->tri.boxes[t];
  const vec3 p = w->self.paths[b->v[0]].begin;
  const vec3 q = w->self.paths[b->v[1]].begin;
  const vec3 r = w->self.paths[b->v[2]].begin;
  const vec3 margins = vec_make(margin, margin, margin);
  b->low = vec_sub(vec_min(vec_min(p, q), r), margins);
  b->high = vec_add(vec_max(vec_max(p, q), r), margins);
}

/* Its paths in this tick, less the mean of its patch. */
static void set_swept_box(fray_world *w, uint32_t t, int32_t margin) {
  triangle_box *b = &w->tri.boxes[t];
  const vec3 mean = w->tri.patches[b->patch].mean;
  const vec3 margins = vec_make(margin, margin, margin);
  set_box(w, t, margin);
  for (uint32_t k = 0; k < 3; ++k) {
    const vec3 end = vec_sub(w->self.paths[b->v[k]].end, mean);
    b->low = vec_min(b->low, vec_sub(end, margins));
    b->high = vec_max(b->high, vec_add(end, margins));
  }
}

static const box_cluster empty_box = {{INT32_MAX, INT32_MAX, INT32_MAX},
                                      {-INT32_MAX, -INT32_MAX, -INT32_MAX}};

static void include_box(box_cluster *all, vec3 low, vec3 high) {
  all->low = vec_min(all->low, low);
  all->high = vec_max(all->high, high);
}

/* Boxes of a patch and of its clusters; that of a cluster has the place of its first triangle. */
static void set_patch_boxes(fray_world *w, triangle_patch *patch) {
  box_cluster all = empty_box;
  for (uint32_t first = patch->first; first < patch->end; first += BOX_CLUSTER) {
    box_cluster *cluster = &w->tri.clusters[first];
    *cluster = empty_box;
    for (uint32_t n = first; n < patch->end && n < first + BOX_CLUSTER; ++n) {
      const triangle_box *b = &w->tri.boxes[w->tri.order[n]];
      include_box(cluster, b->low, b->high);
    }
    include_box(&all, cluster->low, cluster->high);
  }
  patch->low = all.low;
  patch->high = all.high;
}

/* ---- patches at rest ---- */

static uint32_t part_along(const triangle_pair_list *l, int32_t at, uint32_t axis) {
  const int64_t n = ((int64_t)at - l->low[axis]) / l->size[axis];
  return (uint32_t)fx_clamp64(n, 0, (int64_t)l->across * PATCH_PARTS - 1);
}

/* The patch at a triangle's centre at rest. */
static void find_patch(fray_world *w, uint32_t t) {
  const trimesh *s = &w->trimesh;
  const index_t *corner = s->triangle[t].v;
  triangle_box *b = &w->tri.boxes[t];
  const int32_t u = s->u[corner[0]] / 3 + s->u[corner[1]] / 3 + s->u[corner[2]] / 3;
  const int32_t v = s->v[corner[0]] / 3 + s->v[corner[1]] / 3 + s->v[corner[2]] / 3;
  const uint32_t i = part_along(w->tri.list, u, 0);
  const uint32_t j = part_along(w->tri.list, v, 1);
  b->patch = (uint8_t)(j / PATCH_PARTS * w->tri.list->across + i / PATCH_PARTS);
  b->part = (uint8_t)(j % PATCH_PARTS * PATCH_PARTS + i % PATCH_PARTS);
}

static void lay_out(fray_world *w) {
  triangle_pair_list *l = w->tri.list;
  const int32_t *const at[2] = {w->trimesh.u, w->trimesh.v};
  l->across = patches_across(triangles_in_use(w));
  for (uint32_t k = 0; k < 2; ++k) {
    int32_t high = l->low[k] = at[k][0];
    for (uint32_t p = 1; p < w->p.count; ++p) {
      l->low[k] = fx_min(l->low[k], at[k][p]);
      high = fx_max(high, at[k][p]);
    }
    l->size[k] = fx_sub(high, l->low[k]) / ((int32_t)l->across * PATCH_PARTS) + 1;
  }
}

/* Sorts triangles by patch, part and number. */
static void sort_triangles(fray_world *w) {
  enum { PARTS = PATCH_PARTS * PATCH_PARTS };
  triangle_patch *patch = w->tri.patches;
  const uint32_t parts = patches_count(w) * PARTS;
  uint32_t from[PATCHES_MAX * PARTS];
  uint32_t sum = 0;
  FRAY_ASSERT(patches_count(w) <= PATCHES_MAX);
  for (uint32_t n = 0; n < parts; ++n) from[n] = 0;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t)
    ++from[w->tri.boxes[t].patch * PARTS + w->tri.boxes[t].part];
  for (uint32_t n = 0; n < parts; ++n) {
    const uint32_t count = from[n];
    from[n] = sum;
    if (n % PARTS == 0) patch[n / PARTS].first = sum;
    sum += count;
    patch[n / PARTS].end = sum;
  }
  FRAY_ASSERT(sum == triangles_in_use(w));
  for (uint32_t t = 0; t < triangles_in_use(w); ++t)
    w->tri.order[from[w->tri.boxes[t].patch * PARTS + w->tri.boxes[t].part]++] = (index_t)t;
}

/* ---- changes of topology ---- */

/* A triangle that is new, or another one than when it was listed. */
static void renew(fray_world *w, uint32_t t) {
  triangle_box *b = &w->tri.boxes[t];
  for (uint32_t k = 0; k < 3; ++k) b->v[k] = w->trimesh.triangle[t].v[k];
  b->owned = owned_by(w, t);
  b->fast = 0;
  find_patch(w, t);
  w->tri.travel[t].budget = -1;
}

static int is_changed(const fray_world *w, uint32_t t) {
  const index_t *v = w->trimesh.triangle[t].v;
  const triangle_box *b = &w->tri.boxes[t];
  return t >= w->tri.list->triangles || v[0] != b->v[0] || v[1] != b->v[1] || v[2] != b->v[2] ||
         owned_by(w, t) != b->owned;
}

static void remember_topology(fray_world *w) {
  triangle_pair_list *l = w->tri.list;
  sort_triangles(w);
  l->particles = w->p.count;
  l->triangles = triangles_in_use(w);
  l->topology = state_pair(w->state->topology);
}

void patches_begin(fray_world *w) {
  FRAY_ASSERT(world_has_triangle_collision(w) && triangles_in_use(w) <= w->capacity[POOL_TRIANGLES]);
  triangle_pair_list *l = w->tri.list;
  triangle_patch *patch = w->tri.patches;
  int64_t width = 0;
  lay_out(w);
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) {
    renew(w, t);
    set_box(w, t, 0);
    const vec3 size = vec_sub(w->tri.boxes[t].high, w->tri.boxes[t].low);
    width += fx_max(fx_max(size.x, size.y), size.z);
  }
  for (uint32_t a = 0; a < patches_count(w); ++a) {
    patch[a].travelled = patch[a].mean = vec_make(0, 0, 0);
    for (uint32_t b = 0; b < a; ++b) patches_pair(w, a, b)->budget = -1;
  }
  l->default_budget = (int32_t)(width / triangles_in_use(w) / BUDGET_FRACTION) + 1;
  l->pairs = l->lasting = 0;
  l->valid = 1;
  remember_topology(w);
}

void patches_follow(fray_world *w) {
  const triangle_pair_list *l = w->tri.list;
  FRAY_ASSERT(l->valid != 0 && l->pairs <= w->capacity[POOL_TRIANGLE_PAIRS]);
  if (l->topology == state_pair(w->state->topology) && l->particles == w->p.count &&
      l->triangles == triangles_in_use(w))
    return;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t)
    if (is_changed(w, t)) renew(w, t);
  remember_topology(w);
}

/* ---- what is stale ---- */

static void relist(fray_world *w, uint32_t t, int32_t travel) {
  triangle_pair_list *l = w->tri.list;
  triangle_travel *listed = &w->tri.travel[t];
  w->tri.predicted_travel[t] = TRIANGLE_PAIR_STALE;
  listed->allowance = travel;
  FRAY_ASSERT(l->stale < triangles_in_use(w));
  w->tri.stale[l->stale++] = (index_t)t;
  if (l->this_search_only != 0) return;
  w->tri.boxes[t].fast = travel > l->default_budget;
  for (uint32_t k = 0; k < 3; ++k) listed->from[k] = corner_of(w, t, k);
  listed->travelled = 0;
  listed->budget = listed->allowance = fx_max(travel, l->default_budget);
}

/* What its pairs are listed for ends with this tick. */
static int is_for_tick(const fray_world *w, uint32_t t) {
  return w->tri.predicted_travel[t] == TRIANGLE_PAIR_STALE &&
         (w->tri.list->this_search_only != 0 || w->tri.boxes[t].fast != 0);
}

static void set_boxes(fray_world *w) {
  const int64_t margin = patches_distance_min(w) / 2 + 1;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t)
    if (is_for_tick(w, t)) set_swept_box(w, t, fx_saturate(margin));
    else set_box(w, t, fx_saturate(margin + w->tri.travel[t].allowance));
  for (uint32_t a = 0; a < patches_count(w); ++a) set_patch_boxes(w, &w->tri.patches[a]);
}

void patches_find_stale(fray_world *w) {
  triangle_pair_list *l = w->tri.list;
  triangle_patch *patch = w->tri.patches;
  l->stale = 0;
  for (uint32_t a = 0; a < patches_count(w); ++a) patch[a].mean = mean_path(w, &patch[a]);
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) {
    triangle_travel *listed = &w->tri.travel[t];
    const int32_t travel = tick_travel(w, t);
    l->out_of_range |= travel == PATCHES_TOO_FAR ? 1u : 0u;
    listed->travelled = listed->budget < 0 ? 0 : travel_since(w, t);
    listed->allowance = fx_saturate((int64_t)listed->budget + listed->travelled);
    w->tri.predicted_travel[t] = listed->travelled + travel;
    if (w->tri.boxes[t].fast != 0 || w->tri.predicted_travel[t] > listed->budget) relist(w, t, travel);
  }
  set_boxes(w);
}

/* Two patches without listed pairs, or with pairs that do not last to the end of the tick. */
static void relist_patches(fray_world *w, uint32_t a, uint32_t b, vec3 from, int32_t travel) {
  const triangle_pair_list *l = w->tri.list;
  const triangle_patch *patch = w->tri.patches;
  patch_pair *pair = patches_pair(w, a, b);
  const int32_t allowance = l->this_search_only != 0 ? travel : fx_max(travel, l->default_budget);
  triangle_patch wider = patch[a];
  patches_widen(&wider.low, &wider.high, allowance);
  const int is_near = patches_overlap(wider.low, wider.high, patch[b].low, patch[b].high);
  pair->predicted_travel = TRIANGLE_PAIR_STALE;
  pair->allowance = is_near ? allowance : -1;
  if (l->this_search_only != 0) return;
  pair->from = from;
  pair->travelled = 0;
  pair->budget = pair->allowance;
}

void patches_find_neighbours(fray_world *w) {
  triangle_pair_list *l = w->tri.list;
  triangle_patch *patch = w->tri.patches;
  for (uint32_t a = 0; a < patches_count(w); ++a) patch[a].neighbours = (uint64_t)1 << a;
  for (uint32_t a = 0; a < patches_count(w); ++a)
    for (uint32_t b = 0; b < a; ++b) {
      patch_pair *pair = patches_pair(w, a, b);
      const vec3 from = vec_wrap_sub(patch[a].travelled, patch[b].travelled);
      const int32_t travel = patches_travel(patch[a].mean, patch[b].mean, vec_make(0, 0, 0));
      l->out_of_range |= travel == PATCHES_TOO_FAR ? 1u : 0u;
      pair->travelled = pair->budget < 0 ? 0 : length_of(vec_wrap_sub(from, pair->from));
      pair->allowance = fx_saturate((int64_t)pair->budget + pair->travelled);
      pair->predicted_travel = pair->travelled + travel;
      if (pair->predicted_travel > pair->budget) {
        relist_patches(w, a, b, from, travel);
        continue;
      }
      patch[a].neighbours |= (uint64_t)1 << b;
      patch[b].neighbours |= (uint64_t)1 << a;
    }
}
