/* SPDX-License-Identifier: Apache-2.0 */
/* Triangle sheets, from a scene to a world: mesh, vertices with the held ones first, cloth, steps.
 */
#include <stdlib.h>
#include <string.h>

#include "rt/model/image.h"
#include "tools/build/draft.h"
#include "tools/build/mesh.h"
#include "tools/build/triangles.h"

/* The smallest lu of which the longer side of a cell is at most a quarter. */
static int scale(draft *d) {
  static const uint32_t sizes_um[] = {100,   200,   500,    1000,   2000,   5000,   10000,
                                      20000, 50000, 100000, 200000, 500000, 1000000};
  enum { SIZES = sizeof sizes_um / sizeof sizes_um[0] };
  const scene *s = d->scene;
  const exact *edge = s->triangles.edge;
  const exact longest = exact_compare(edge[0], edge[1]) > 0 ? edge[0] : edge[1];
  uint32_t n = 0;
  while (n + 1 < SIZES &&
         exact_compare(exact_mul(longest, exact_make(40000, sizes_um[n])), exact_make(1, 1)) > 0)
    ++n;
  d->lu_um = sizes_um[n];
  d->lu_per_cm = exact_make(10000, d->lu_um);
  if (!draft_length(d, s->triangles.line, edge[0], &d->spacing[0]) ||
      !draft_length(d, s->triangles.line, edge[1], &d->spacing[1]))
    return 0;
  if (4 * (int64_t)fx_min(d->spacing[0], d->spacing[1]) < fx_max(d->spacing[0], d->spacing[1]))
    return draft_refuse(d, s->triangles.line,
                        "edge: expected sides of a cell within a factor of 4");
  d->particle_mass = exact_mul(s->triangles.cloth.density, exact_mul(edge[0], edge[1]));
  return 1;
}

/* Cosine and sine of the weft against the rows, Q30. */
static int weft_axis(const draft *d, int64_t axis[2]) {
  const exact one = exact_make(1, 1);
  const exact h = d->scene->triangles.weft_half_tangent;
  const exact whole = exact_add(one, exact_mul(h, h));
  return exact_to_fixed(exact_div(exact_sub(one, exact_mul(h, h)), whole), 30, &axis[0]) &&
         exact_to_fixed(exact_div(exact_add(h, h), whole), 30, &axis[1]);
}

static int place_points(draft *d, const mesh *m) {
  const scene *s = d->scene;
  int32_t width = 0;
  int32_t height = 0;
  vec3 centre;
  if (!draft_place(d, s->triangles.line, s->sheet.at, &centre)) return 0;
  for (uint32_t p = 0; p < m->points; ++p) {
    width = fx_max(width, m->s[p]);
    height = fx_max(height, m->t[p]);
  }
  for (uint32_t p = 0; p < m->points; ++p) {
    const int64_t x = (int64_t)centre.x + m->s[p] - width / 2;
    const int64_t up = (int64_t)m->t[p] - height / 2;
    const int64_t y = centre.y + (s->sheet.vertical ? up : 0);
    const int64_t z = centre.z - (s->sheet.vertical ? 0 : up);
    const int64_t edge = FX_WORLD_MAX;
    if (x > edge || x < -edge || y > edge || y < -edge || z > edge || z < -edge)
      return draft_refuse(d, s->triangles.line, "triangles: reach outside of the world of %u mm",
                          120u * d->lu_um / 1000u);
    d->place[p] = vec_make((int32_t)x, (int32_t)y, (int32_t)z);
  }
  return 1;
}

/* Held ones first, else as they come. */
static void number_points(draft *d) {
  uint32_t held = 0;
  uint32_t next = d->held;
  for (uint32_t p = 0; p < d->crossings; ++p) {
    d->particle[p] = d->holder[p] != DRAFT_FREE ? held++ : next++;
    d->crossing[d->particle[p]] = p;
  }
}

static int begin(draft *d, mesh *m) {
  d->crossings = m->points;
  d->place = calloc(m->points, sizeof *d->place);
  d->holder = calloc(m->points, sizeof *d->holder);
  d->particle = calloc(m->points, sizeof *d->particle);
  d->crossing = calloc(m->points, sizeof *d->crossing);
  if (d->place == NULL || d->holder == NULL || d->particle == NULL || d->crossing == NULL)
    return draft_refuse(d, 0, "out of memory");
  if (!place_points(d, m) || !draft_holders(d, m->column, m->row)) return 0;
  number_points(d);
  return 1;
}

/* Its triangles, and not only its vertices, have something to meet. */
static int meets_bodies(const draft *d) {
  for (uint32_t b = 0; b < d->bodies; ++b)
    if (d->scene->triangles.whole && (d->body[b].shape == FRAY_MESH || d->body[b].shape == FRAY_BALL))
      return 1;
  return 0;
}

static void plan(const draft *d, const mesh *m, uint32_t capacity[POOLS]) {
  const scene *s = d->scene;
  memset(capacity, 0, POOLS * sizeof *capacity);
  capacity[POOL_PARAMS] = capacity[POOL_STATE] = 1;
  capacity[POOL_LINK_CLASSES] = capacity[POOL_SPRING_CLASSES] = 1;
  capacity[POOL_PARTICLES] =
      m->points + (s->limits.has_spare_particles ? s->limits.spare_particles : m->points);
  capacity[POOL_TRIANGLES] =
      m->triangles + (s->limits.has_spare_triangles ? s->limits.spare_triangles : m->triangles);
  capacity[POOL_HELD] = d->held;
  capacity[POOL_BODIES] = d->bodies;
  capacity[POOL_KEYS] = s->key_count;
  capacity[POOL_CONTACTS] = s->limits.has_contacts ? s->limits.contacts : m->points;
  capacity[POOL_CUTS] = s->limits.cuts_per_tick;
  capacity[POOL_MESH_WORDS] = draft_mesh_words(d);
  capacity[POOL_LAYERS] = !s->sheet.selves ? 0 : s->limits.self_pairs != 0 ? s->limits.self_pairs : 16u * m->triangles;
  capacity[POOL_BLADES] = s->triangles.cloth.is_cut && d->meshes.head.meshes > 0;
}

static int fill_vertices(const draft *d, const mesh *m, fray_world *w) {
  int64_t axis[2];
  if (!weft_axis(d, axis))
    return draft_refuse(d, d->scene->triangles.line, "weft: an angle that cannot be held");
  for (uint32_t p = 0; p < m->points; ++p) {
    const uint32_t from = d->crossing[p];
    const int64_t s = m->s[from];
    const int64_t t = m->t[from];
    w->x[p] = d->place[from].x;
    w->y[p] = d->place[from].y;
    w->z[p] = d->place[from].z;
    w->sheet.u[p] = (int32_t)fx_round64(s * axis[0] + t * axis[1], 30);
    w->sheet.v[p] = (int32_t)fx_round64(t * axis[0] - s * axis[1], 30);
  }
  for (uint32_t p = 0; p < d->held; ++p) {
    const uint8_t b = d->holder[d->crossing[p]];
    WRITABLE(uint8_t, w->grip_body)[p] = b;
    WRITABLE(int32_t, w->grip_x)[p] = w->x[p] - w->body_states[b].position[0];
    WRITABLE(int32_t, w->grip_y)[p] = w->y[p] - w->body_states[b].position[1];
    WRITABLE(int32_t, w->grip_z)[p] = w->z[p] - w->body_states[b].position[2];
  }
  return 1;
}

/* A side from its lesser to its greater vertex, and whose it is. */
typedef struct {
  uint32_t low, high, triangle, side;
} mesh_side;

static int by_ends(const void *a, const void *b) {
  const mesh_side *p = (const mesh_side *)a;
  const mesh_side *q = (const mesh_side *)b;
  if (p->low != q->low) return p->low < q->low ? -1 : 1;
  if (p->high != q->high) return p->high < q->high ? -1 : 1;
  return p->triangle < q->triangle ? -1 : p->triangle > q->triangle;
}

static int join_sides(const draft *d, sheet_mesh *s, uint32_t triangles) {
  mesh_side *sides = calloc((size_t)triangles * 3, sizeof *sides);
  if (sides == NULL) return draft_refuse(d, 0, "out of memory");
  for (uint32_t n = 0; n < 3 * triangles; ++n) {
    const sheet_triangle *f = &s->triangle[n / 3];
    const uint32_t from = f->v[sheet_next(n % 3)];
    const uint32_t to = f->v[sheet_last(n % 3)];
    const mesh_side side = {from < to ? from : to, from < to ? to : from, n / 3, n % 3};
    sides[n] = side;
    s->triangle[n / 3].across[n % 3] = (row_id)(n / 3);
  }
  qsort(sides, (size_t)triangles * 3, sizeof *sides, by_ends);
  for (uint32_t n = 0; n + 1 < 3 * triangles; ++n)
    if (sides[n].low == sides[n + 1].low && sides[n].high == sides[n + 1].high) {
      s->triangle[sides[n].triangle].across[sides[n].side] = (row_id)sides[n + 1].triangle;
      s->triangle[sides[n + 1].triangle].across[sides[n + 1].side] = (row_id)sides[n].triangle;
    }
  free(sides);
  return 1;
}

/* The lowest triangle of a closed fan, the first of an open one. */
static void find_fans(const fray_world *w, uint32_t triangles) {
  const sheet_mesh *s = &w->sheet;
  for (uint32_t left = 3 * triangles; left > 0; --left) {
    const uint32_t n = left - 1;
    s->fan[s->triangle[n / 3].v[n % 3]] = (row_id)(n / 3);
  }
  for (uint32_t n = 0; n < 3 * triangles; ++n)
    if (sheet_across(s, n / 3, sheet_last(n % 3)) == SHEET_NONE)
      s->fan[s->triangle[n / 3].v[n % 3]] = (row_id)(n / 3);
}

static int fill_triangles(const draft *d, const mesh *m, fray_world *w) {
  sheet_mesh *s = &w->sheet;
  s->state->triangles = (int32_t)m->triangles;
  for (uint32_t t = 0; t < m->triangles; ++t) {
    for (uint32_t k = 0; k < 3; ++k) s->triangle[t].v[k] = (row_id)d->particle[m->corner[t][k]];
    const sheet_triangle *f = &s->triangle[t];
    const int64_t twice =
        sheet_twice_area(sheet_at(s, f->v[0]), sheet_at(s, f->v[1]), sheet_at(s, f->v[2]));
    s->area[t] = (uint32_t)fx_round64(twice, 19);
  }
  if (!join_sides(d, s, m->triangles)) return 0;
  find_fans(w, m->triangles);
  return 1;
}

/* Half the thickness, or a 64th of the least height of a triangle, is what the search allows a push for. */
static int fill_layers(const draft *d, fray_world *w) {
  const int32_t height = w->sheet.params->height_min; /* a quarter of it */
  selves_params *k = WRITABLE(selves_params, w->selves);
  if (!draft_word(d, "self_thickness", exact_mul(d->scene->sheet.self_thickness, d->lu_per_cm), FX_POSITION_BITS, 1,
                  1 << 22, &k->thickness))
    return 0;
  if (k->thickness > 2 * (int64_t)height)
    return draft_refuse(d, d->scene->triangles.line, "self_thickness, or thickness without it: expected at most %u um, "
                        "half of the least height of a triangle, so that triangles side by side do not meet",
                        (uint32_t)(2 * (int64_t)height * d->lu_um / FX_LU));
  k->slack = fx_max(1, fx_min(height / 16, k->thickness / 2));
  return 1;
}

int draft_triangles(draft *d, void **memory, fray_world **world) {
  uint32_t capacity[POOLS];
  mesh m;
  memset(&m, 0, sizeof m);
  d->grid.warps = d->grid.wefts = 0;
  int good = scale(d) && draft_bodies(d) && mesh_make(d, &m) && begin(d, &m);
  if (good) {
    d->meshes.head.whole = meets_bodies(d);
    plan(d, &m, capacity);
    const size_t bytes = image_blank(capacity, NULL, NULL);
    *memory = aligned_alloc(64, (bytes + 63) / 64 * 64);
    good = *memory != NULL || draft_refuse(d, 0, "out of memory");
  }
  if (good) {
    image_blank(capacity, *memory, world);
    fray_world *w = *world;
    w->particles = m.points;
    good = draft_fill_bodies(d, w) && fill_vertices(d, &m, w) && fill_triangles(d, &m, w) &&
           draft_params(d, WRITABLE(params, w->params)) && draft_cloths(d, w);
    if (good && world_has_layers(w)) good = fill_layers(d, w);
    if (good) {
      draft_mesh_fill(d, WRITABLE(int32_t, w->meshes));
      sheet_derive(w);
      good = draft_mesh_apart(d, w) && draft_sheet_slits(d, w);
      const uint64_t now = sheet_topology(w);
      w->state->topology[0] = (int32_t)(uint32_t)(now & 0xFFFFFFFFu);
      w->state->topology[1] = (int32_t)(uint32_t)(now >> 32);
    }
  }
  mesh_free(&m);
  return good;
}
