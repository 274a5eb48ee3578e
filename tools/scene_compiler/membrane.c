/* SPDX-License-Identifier: Apache-2.0 */
/* Membranes, from a scene to a world: triangles, vertices with the attached ones first, masses, elastic
 * steps. */
#include <stdlib.h>
#include <string.h>

#include "rt/image/image.h"
#include "tools/scene_compiler/draft.h"
#include "tools/scene_compiler/planar_mesh.h"
#include "tools/scene_compiler/membrane.h"

/* The smallest lu for which the longer edge of a cell is at most 1/4 lu. */
static int scale(draft *d) {
  static const uint32_t sizes_um[] = {100,   200,   500,    1000,   2000,   5000,   10000,
                                      20000, 50000, 100000, 200000, 500000, 1000000};
  enum { SIZES = sizeof sizes_um / sizeof sizes_um[0] };
  const scene *s = d->scene;
  const exact *edge = s->membrane.cell;
  const exact longest = exact_compare(edge[0], edge[1]) > 0 ? edge[0] : edge[1];
  uint32_t n = 0;
  while (n + 1 < SIZES &&
         exact_compare(exact_mul(longest, exact_make(40000, sizes_um[n])), exact_make(1, 1)) > 0)
    ++n;
  d->lu_um = sizes_um[n];
  d->lu_per_cm = exact_make(10000, d->lu_um);
  if (!draft_length(d, BLOCK_CLOTH, "cell", edge[0], &d->spacing[0]) ||
      !draft_length(d, BLOCK_CLOTH, "cell", edge[1], &d->spacing[1]))
    return 0;
  if (4 * (int64_t)fx_min(d->spacing[0], d->spacing[1]) < fx_max(d->spacing[0], d->spacing[1]))
    return draft_expected(d, BLOCK_CLOTH, "cell", "two edges within a factor of 4");
  d->particle_mass = exact_mul(s->membrane.cloth.density, exact_mul(edge[0], edge[1]));
  return 1;
}

/* Cosine and sine of the weft against the rows, Q30. */
static int weft_axis(const draft *d, int64_t axis[2]) {
  const exact one = exact_make(1, 1);
  const exact h = d->scene->membrane.weft_half_tangent;
  const exact whole = exact_add(one, exact_mul(h, h));
  return exact_to_fixed(exact_div(exact_sub(one, exact_mul(h, h)), whole), 30, &axis[0]) &&
         exact_to_fixed(exact_div(exact_add(h, h), whole), 30, &axis[1]);
}

static int place_points(draft *d, const planar_mesh *m) {
  const scene *s = d->scene;
  int32_t width = 0;
  int32_t height = 0;
  vec3 centre;
  if (!draft_position(d, BLOCK_CLOTH, s->woven.at, &centre)) return 0;
  for (uint32_t p = 0; p < m->points; ++p) {
    width = fx_max(width, m->s[p]);
    height = fx_max(height, m->t[p]);
  }
  for (uint32_t p = 0; p < m->points; ++p) {
    const int64_t x = (int64_t)centre.x + m->s[p] - width / 2;
    const int64_t up = (int64_t)m->t[p] - height / 2;
    const int64_t y = centre.y + (s->woven.vertical ? up : 0);
    const int64_t z = centre.z - (s->woven.vertical ? 0 : up);
    const int64_t edge = FX_WORLD_MAX;
    if (x > edge || x < -edge || y > edge || y < -edge || z > edge || z < -edge)
      return draft_outside(d);
    d->place[p] = vec_make((int32_t)x, (int32_t)y, (int32_t)z);
  }
  return 1;
}

/* Attached ones first, else in the order of the points. */
static void number_points(draft *d) {
  uint32_t held = 0;
  uint32_t next = d->attached;
  for (uint32_t p = 0; p < d->crossings; ++p) {
    d->particle[p] = d->holder[p] != DRAFT_FREE ? held++ : next++;
    d->crossing[d->particle[p]] = p;
  }
}

static int begin(draft *d, planar_mesh *m) {
  d->crossings = m->points;
  d->place = calloc(m->points, sizeof *d->place);
  d->holder = calloc(m->points, sizeof *d->holder);
  d->particle = calloc(m->points, sizeof *d->particle);
  d->crossing = calloc(m->points, sizeof *d->crossing);
  if (d->place == NULL || d->holder == NULL || d->particle == NULL || d->crossing == NULL)
    return draft_no_memory(d);
  if (!place_points(d, m) || !draft_attach(d, m->column, m->row)) return 0;
  number_points(d);
  return 1;
}

/* There are bodies that collide with triangles, not only with vertices. */
static int triangles_collide(const draft *d) {
  for (uint32_t b = 0; b < d->bodies; ++b)
    if (d->scene->membrane.collide_triangles &&
        (body_is_mesh(&d->body[b]) || body_is_sphere_collider(&d->body[b])))
      return 1;
  return 0;
}

static void plan(const draft *d, const planar_mesh *m, uint32_t capacity[POOLS]) {
  const scene *s = d->scene;
  memset(capacity, 0, POOLS * sizeof *capacity);
  capacity[POOL_PARAMS] = capacity[POOL_STATE] = 1;
  capacity[POOL_LINK_CLASSES] = capacity[POOL_BEND_SHEAR_CLASSES] = 1;
  capacity[POOL_PARTICLES] =
      m->points + (s->limits.has_spare_particles ? s->limits.spare_particles : m->points);
  capacity[POOL_TRIANGLES] =
      m->triangles + (s->limits.has_spare_triangles ? s->limits.spare_triangles : m->triangles);
  capacity[POOL_ATTACHED] = d->attached;
  capacity[POOL_BODIES] = d->bodies;
  capacity[POOL_KEYS] = s->key_count;
  capacity[POOL_CONTACTS] = s->limits.has_contacts ? s->limits.contacts : capacity[POOL_PARTICLES];
  capacity[POOL_BREAKS] = s->limits.tears_per_tick;
  capacity[POOL_RIGID_MESH_WORDS] = draft_rigid_mesh_words(d);
  capacity[POOL_TRIANGLE_PAIRS] = !s->woven.self_collision              ? 0
                                  : s->limits.self_collision_pairs != 0 ? s->limits.self_collision_pairs
                                                                        : 16u * m->triangles;
  capacity[POOL_COROTATIONAL] = s->membrane.cloth.corotational != 0;
  capacity[POOL_CRACKS] = s->membrane.cloth.breaks.numerator != 0;
  capacity[POOL_HANDLES] = draft_has_handles(d) ? FRAY_HANDS : 0;
  capacity[POOL_BLADES] = s->membrane.cloth.has_cut_speed && d->meshes.head.meshes > 0;
}

static int fill_vertices(const draft *d, const planar_mesh *m, fray_world *w) {
  int64_t axis[2];
  if (!weft_axis(d, axis))
    return draft_expected(d, BLOCK_CLOTH, "weft", "an angle of fewer digits");
  draft_fill_particles(d, w);
  for (uint32_t p = 0; p < m->points; ++p) {
    const uint32_t from = d->crossing[p];
    const int64_t s = m->s[from];
    const int64_t t = m->t[from];
    w->trimesh.u[p] = (int32_t)fx_round64(s * axis[0] + t * axis[1], 30);
    w->trimesh.v[p] = (int32_t)fx_round64(t * axis[0] - s * axis[1], 30);
  }
  return 1;
}

/* An edge of a triangle, from its lower to its higher vertex. */
typedef struct {
  uint32_t low, high, triangle, side;
} half_edge;

static int by_ends(const void *a, const void *b) {
  const half_edge *p = (const half_edge *)a;
  const half_edge *q = (const half_edge *)b;
  if (p->low != q->low) return p->low < q->low ? -1 : 1;
  if (p->high != q->high) return p->high < q->high ? -1 : 1;
  return p->triangle < q->triangle ? -1 : p->triangle > q->triangle;
}

static int join_sides(const draft *d, trimesh *s, uint32_t triangles) {
  half_edge *sides = calloc((size_t)triangles * 3, sizeof *sides);
  if (sides == NULL) return draft_no_memory(d);
  for (uint32_t n = 0; n < 3 * triangles; ++n) {
    const trimesh_triangle *f = &s->triangle[n / 3];
    const uint32_t from = f->v[trimesh_next(n % 3)];
    const uint32_t to = f->v[trimesh_previous(n % 3)];
    const half_edge side = {from < to ? from : to, from < to ? to : from, n / 3, n % 3};
    sides[n] = side;
    s->triangle[n / 3].neighbour[n % 3] = (index_t)(n / 3);
  }
  qsort(sides, (size_t)triangles * 3, sizeof *sides, by_ends);
  for (uint32_t n = 0; n + 1 < 3 * triangles; ++n)
    if (sides[n].low == sides[n + 1].low && sides[n].high == sides[n + 1].high) {
      s->triangle[sides[n].triangle].neighbour[sides[n].side] = (index_t)sides[n + 1].triangle;
      s->triangle[sides[n + 1].triangle].neighbour[sides[n + 1].side] = (index_t)sides[n].triangle;
    }
  free(sides);
  return 1;
}

/* The lowest triangle of a closed one-ring, the first of an open one. */
static void find_one_rings(const fray_world *w, uint32_t triangles) {
  const trimesh *s = &w->trimesh;
  for (uint32_t left = 3 * triangles; left > 0; --left) {
    const uint32_t n = left - 1;
    s->first_triangle[s->triangle[n / 3].v[n % 3]] = (index_t)(n / 3);
  }
  for (uint32_t n = 0; n < 3 * triangles; ++n)
    if (trimesh_neighbour(s, n / 3, trimesh_previous(n % 3)) == TRIMESH_NONE)
      s->first_triangle[s->triangle[n / 3].v[n % 3]] = (index_t)(n / 3);
}

static int fill_triangles(const draft *d, const planar_mesh *m, fray_world *w) {
  trimesh *s = &w->trimesh;
  s->state->triangles = (int32_t)m->triangles;
  for (uint32_t t = 0; t < m->triangles; ++t) {
    for (uint32_t k = 0; k < 3; ++k) s->triangle[t].v[k] = (index_t)d->particle[m->corner[t][k]];
    const trimesh_triangle *f = &s->triangle[t];
    const int64_t twice =
        trimesh_twice_area(trimesh_at(s, f->v[0]), trimesh_at(s, f->v[1]), trimesh_at(s, f->v[2]));
    s->area[t] = (uint32_t)fx_round64(twice, 19);
  }
  if (!join_sides(d, s, m->triangles)) return 0;
  find_one_rings(w, m->triangles);
  return 1;
}

/* The search allows pushes of half the thickness or 1/64 of the least height of a triangle. */
static int fill_triangle_collision(const draft *d, fray_world *w) {
  const int32_t height = w->trimesh.params->height_min; /* a quarter of it */
  self_params *k = WRITABLE(self_params, w->self.constants);
  const char *key = d->scene->woven.has_self_thickness ? "self_thickness" : "thickness";
  const exact given = d->scene->woven.self_thickness;
  char most[SOURCE_VALUE];
  if (!draft_fixed_point(d, draft_given(BLOCK_CLOTH, key, UNIT_LENGTH, given), exact_mul(given, d->lu_per_cm),
                         FX_POSITION_BITS, 1, 1 << 22, &k->thickness))
    return 0;
  if (k->thickness > 2 * (int64_t)height)
    return draft_expected(
        d, BLOCK_CLOTH, key,
        "at most %s with 'self_collision', half of the least height of a triangle, so that triangles "
        "side by side do not meet",
        draft_value(d, BLOCK_CLOTH, key, UNIT_LENGTH,
                    exact_div(exact_make(2 * (int64_t)height, FX_LU), d->lu_per_cm), -1, most));
  k->slack = fx_max(1, fx_min(height / 16, k->thickness / 2));
  return 1;
}

int draft_membrane(draft *d, void **memory, fray_world **world) {
  uint32_t capacity[POOLS];
  planar_mesh m;
  memset(&m, 0, sizeof m);
  d->grid.warps = d->grid.wefts = 0;
  int good = scale(d) && draft_place_bodies(d) && planar_mesh_make(d, &m) && begin(d, &m);
  if (good) {
    d->meshes.head.meets_triangles = triangles_collide(d);
    plan(d, &m, capacity);
    const size_t bytes = image_blank(capacity, NULL, NULL);
    *memory = aligned_alloc(64, (bytes + 63) / 64 * 64);
    good = *memory != NULL || draft_no_memory(d);
  }
  if (good) {
    image_blank(capacity, *memory, world);
    fray_world *w = *world;
    w->p.count = m.points;
    good = draft_fill_bodies(d, w) && fill_vertices(d, &m, w) && fill_triangles(d, &m, w) &&
           draft_params(d, WRITABLE(params, w->params)) && draft_membrane_params(d, w);
    if (good && world_has_handles(w)) good = draft_handles(d, w);
    if (good && world_has_triangle_collision(w)) good = fill_triangle_collision(d, w);
    if (good) {
      draft_rigid_mesh_fill(d, WRITABLE(int32_t, w->rigid.mesh_words));
      trimesh_derive(w);
      good = draft_body_clearance(d, w) && draft_mesh_clearance(d, w) && draft_membrane_slits(d, w);
      const uint64_t now = trimesh_topology(w);
      w->state->topology[0] = (int32_t)(uint32_t)(now & 0xFFFFFFFFu);
      w->state->topology[1] = (int32_t)(uint32_t)(now >> 32);
    }
  }
  planar_mesh_free(&m);
  return good;
}
