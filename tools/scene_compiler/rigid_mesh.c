/* SPDX-License-Identifier: Apache-2.0 */
/* Rigid meshes: an OBJ file in exact decimals becomes points in Q24 lu around the body's position, rotated
 * with it, faces with normals, edges, marks of sharp ones, and a tree of boxes. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rt/geometry/ccd.h"
#include "tools/scene_compiler/draft.h"
#include "tools/mesh_import/obj.h"

/* Least height of a triangle, Q24: 2^-12 lu. */
enum { HEIGHT_MIN = 1 << (FX_POSITION_BITS - 12) };

typedef struct {
  draft *d;
  uint32_t n; /* body */
  const scene_body *b;
  rigid_body *k;
  char file[sizeof(((scene_error *)0)->file)];
  obj_mesh obj;
  vec3 *at;
  vec3 *normal;    /* of triangles */
  uint32_t *order; /* face -> triangle */
  uint32_t *face;  /* triangle -> face */
} loading;

static int refuse(const loading *m, int line, const char *what) {
  return obj_refuse(m->d->error, m->file, line, 0, "%s", what);
}

/* Relative to the scene's folder, unless it begins with a slash. */
static int find_file(loading *m) {
  const char *scene_file = m->d->file;
  const char *slash = strrchr(scene_file, '/');
  const int folder = m->b->obj[0] == '/' || slash == NULL ? 0 : (int)(slash - scene_file) + 1;
  const int length = snprintf(m->file, sizeof m->file, "%.*s%s", folder, scene_file, m->b->obj);
  if (length < 0 || (size_t)length >= sizeof m->file)
    return draft_expected(m->d, BLOCK_BODY + m->n, "obj",
                          "a path of less than %d characters with the scene's folder", (int)sizeof m->file);
  return 1;
}

static int refuse_reach(const loading *m, int line) {
  const exact reach = exact_div(exact_make(RIGID_MESH_REACH_MAX / FX_LU, 1), m->d->lu_per_cm);
  char most[SOURCE_VALUE];
  return obj_refuse(m->d->error, m->file, line, 0,
                    "found a point too far out, expected all within %s of the mesh's origin along each axis, "
                    "and "
                    "numbers of few digits",
                    draft_value(m->d, BLOCK_BODY + m->n, "unit", UNIT_LENGTH, reach, -1, most));
}

static int place_point(loading *m, uint32_t n) {
  const obj_point *p = &m->obj.points[n];
  const exact scale = exact_mul(m->b->unit, m->d->lu_per_cm);
  int64_t local[3];
  int64_t turned[3] = {0, 0, 0};
  int good = 1;
  for (uint32_t a = 0; a < 3 && good; ++a)
    good = exact_to_fixed(exact_mul(p->at[a], scale), FX_POSITION_BITS, &local[a]) &&
           local[a] >= -FX_WORLD_MAX && local[a] <= FX_WORLD_MAX;
  for (uint32_t k = 0; k < 3 && good; ++k) {
    for (uint32_t a = 0; a < 3; ++a) turned[k] += local[a] * m->k->axes[3 * a + k];
    turned[k] = fx_round64(turned[k], 30);
    good = turned[k] >= -RIGID_MESH_REACH_MAX && turned[k] <= RIGID_MESH_REACH_MAX;
  }
  if (!good)
    return refuse_reach(m, p->line);
  m->at[n] = vec_make((int32_t)turned[0], (int32_t)turned[1], (int32_t)turned[2]);
  return 1;
}

typedef struct {
  vec3 at;
  uint32_t point;
} placed;

static int compare_numbers(int64_t a, int64_t b) { return (a > b) - (a < b); }
static int compare_placed(const void *left, const void *right) {
  const placed *l = left;
  const placed *r = right;
  if (l->at.x != r->at.x) return compare_numbers(l->at.x, r->at.x);
  if (l->at.y != r->at.y) return compare_numbers(l->at.y, r->at.y);
  if (l->at.z != r->at.z) return compare_numbers(l->at.z, r->at.z);
  return compare_numbers(l->point, r->point);
}

static int check_apart(const loading *m) {
  placed *list = calloc(m->obj.point_count, sizeof *list);
  if (list == NULL) return refuse(m, 0, "not enough memory");
  for (uint32_t n = 0; n < m->obj.point_count; ++n) {
    list[n].at = m->at[n];
    list[n].point = n;
  }
  qsort(list, m->obj.point_count, sizeof *list, compare_placed);
  int good = 1;
  for (uint32_t n = 1; n < m->obj.point_count && good; ++n)
    if (vec_squared(vec_sub(list[n].at, list[n - 1].at)) == 0)
      good = obj_refuse(m->d->error, m->file, m->obj.points[list[n].point].line, 0,
                        "found point %u where point %u lies, expected one point for both",
                        list[n].point + 1, list[n - 1].point + 1);
  free(list);
  return good;
}

static vec3 corner(const loading *m, uint32_t triangle, uint32_t k) {
  return m->at[m->obj.triangles[triangle].point[k % 3]];
}

/* Twice the area over the longest side, rounded down. */
static uint64_t height_of(const loading *m, uint32_t t) {
  const vec3 a = corner(m, t, 0);
  const vec3 u = vec_sub(corner(m, t, 1), a);
  const vec3 v = vec_sub(corner(m, t, 2), a);
  uint64_t longest = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    const uint64_t side = vec_squared(vec_sub(corner(m, t, k + 1), corner(m, t, k)));
    if (side > longest) longest = side;
  }
  /* components of the product below 2^60, to 2^30 */
  const int64_t n[3] = {fx_mul_wide(u.y, v.z) - fx_mul_wide(u.z, v.y),
                  fx_mul_wide(u.z, v.x) - fx_mul_wide(u.x, v.z),
                  fx_mul_wide(u.x, v.y) - fx_mul_wide(u.y, v.x)};
  unsigned shift = 0;
  for (uint32_t k = 0; k < 3; ++k)
    while (fx_asr64(n[k], shift) > 1 << 30 || fx_asr64(n[k], shift) < -(1 << 30)) ++shift;
  uint64_t squared = 0;
  for (uint32_t k = 0; k < 3; ++k) squared += fx_square((int32_t)fx_asr64(n[k], shift));
  const uint64_t side = exact_sqrt(longest);
  return side == 0 ? 0 : ((uint64_t)exact_sqrt(squared) << shift) / side;
}

static int check_triangles(loading *m) {
  uint32_t first = 0; /* triangle of the face of this one */
  for (uint32_t t = 0; t < m->obj.triangle_count; ++t) {
    const obj_triangle *o = &m->obj.triangles[t];
    m->normal[t] = rigid_mesh_normal(corner(m, t, 0), corner(m, t, 1), corner(m, t, 2));
    if (height_of(m, t) < HEIGHT_MIN)
      return obj_refuse(m->d->error, m->file, o->line, 0,
                        "found a triangle of points %u, %u and %u that is flatter than %u nm, expected "
                        "none without area",
                        o->point[0] + 1, o->point[1] + 1, o->point[2] + 1, m->d->lu_um * 1000u / 4096u);
    if (o->face != m->obj.triangles[first].face) first = t;
    if (t != first && vec_dot_unit(m->normal[t], m->normal[first]) <= 0)
      return refuse(m, o->line, "found a face that its first corner does not see all of, expected a "
                                "convex one, or triangles");
  }
  return 1;
}

/* A closed mesh has a positive volume: six times that, of points rounded to 14 bits. */
static int check_outside(const loading *m) {
  uint32_t span = 0;
  int64_t volume = 0;
  unsigned shift = 0;
  for (uint32_t e = 0; e < m->obj.edge_count; ++e)
    if (m->obj.edges[e].triangle[1] == OBJ_NONE) return 1;
  for (uint32_t n = 0; n < m->obj.point_count; ++n)
    span |= fx_magnitude(m->at[n].x) | fx_magnitude(m->at[n].y) | fx_magnitude(m->at[n].z);
  while (span >> shift > 1 << 14) ++shift;
  for (uint32_t t = 0; t < m->obj.triangle_count; ++t) {
    int64_t p[3][3];
    for (uint32_t k = 0; k < 3; ++k) {
      const vec3 v = corner(m, t, k);
      p[k][0] = fx_asr(v.x, shift);
      p[k][1] = fx_asr(v.y, shift);
      p[k][2] = fx_asr(v.z, shift);
    }
    for (uint32_t k = 0; k < 3; ++k)
      volume += p[0][k] * (p[1][(k + 1) % 3] * p[2][(k + 2) % 3] - p[1][(k + 2) % 3] * p[2][(k + 1) % 3]);
  }
  return volume >= 0 || refuse(m, m->obj.triangles[0].line,
                               "found a closed mesh whose faces look inwards, expected them anticlockwise "
                               "as seen from outside");
}

static rigid_mesh_box box_around(const loading *m, uint32_t low, uint32_t high) {
  rigid_mesh_box b;
  const vec3 first = corner(m, m->order[low], 0);
  const int32_t start[3] = {first.x, first.y, first.z};
  memcpy(b.low, start, sizeof start);
  memcpy(b.high, start, sizeof start);
  for (uint32_t n = low; n < high; ++n)
    for (uint32_t k = 0; k < 3; ++k) {
      const vec3 v = corner(m, m->order[n], k);
      const int32_t at[3] = {v.x, v.y, v.z};
      for (uint32_t a = 0; a < 3; ++a) {
        b.low[a] = fx_min(b.low[a], at[a]);
        b.high[a] = fx_max(b.high[a], at[a]);
      }
    }
  b.next = 0;
  b.face = RIGID_MESH_NONE;
  return b;
}

typedef struct {
  int64_t middle;
  uint32_t triangle;
} ranked;

static int compare_ranked(const void *left, const void *right) {
  const ranked *l = left;
  const ranked *r = right;
  if (l->middle != r->middle) return compare_numbers(l->middle, r->middle);
  return compare_numbers(l->triangle, r->triangle);
}

/* Sorts triangles [low, high) of the order by their middles along an axis. */
static void rank(const loading *m, ranked *scratch, uint32_t low, uint32_t high, uint32_t axis) {
  for (uint32_t n = low; n < high; ++n) {
    int64_t sum = 0;
    for (uint32_t k = 0; k < 3; ++k) {
      const vec3 v = corner(m, m->order[n], k);
      const int32_t at[3] = {v.x, v.y, v.z};
      sum += at[axis];
    }
    scratch[n].middle = sum;
    scratch[n].triangle = m->order[n];
  }
  qsort(scratch + low, high - low, sizeof *scratch, compare_ranked);
  for (uint32_t n = low; n < high; ++n) m->order[n] = scratch[n].triangle;
}

/* Halves by number, so that the depth is the logarithm. Returns the next free box. */
static int32_t add_boxes(loading *m, ranked *scratch, rigid_mesh_box *boxes, int32_t at, uint32_t low,
                         uint32_t high) {
  rigid_mesh_box b = box_around(m, low, high);
  if (high - low == 1) {
    b.face = (int32_t)low;
    b.next = at + 1;
    boxes[at] = b;
    return b.next;
  }
  uint32_t axis = 0;
  for (uint32_t a = 1; a < 3; ++a)
    if (b.high[a] - b.low[a] > b.high[axis] - b.low[axis]) axis = a;
  rank(m, scratch, low, high, axis);
  const uint32_t middle = low + (high - low) / 2;
  const int32_t second = add_boxes(m, scratch, boxes, at + 1, low, middle);
  b.next = add_boxes(m, scratch, boxes, second, middle, high);
  boxes[at] = b;
  return b.next;
}

static void *grown(void *list, int32_t count, size_t size) {
  return realloc(list, (size_t)count * size);
}

/* Grows the tables; new elements are zero. */
static int reserve(loading *m) {
  draft_rigid_meshes *t = &m->d->meshes;
  const rigid_mesh_head old = t->head;
  const uint64_t points = (uint64_t)(uint32_t)old.points + m->obj.point_count;
  const uint64_t faces = (uint64_t)(uint32_t)old.faces + m->obj.triangle_count;
  if (points > MAX_MESH_POINTS || faces > MAX_MESH_FACES)
    return obj_refuse(m->d->error, m->file, 0, 0,
                      "has %u points and %u triangles, expected at most %d and %d in all meshes of a scene",
                      m->obj.point_count, m->obj.triangle_count, MAX_MESH_POINTS, MAX_MESH_FACES);
  rigid_mesh_entry *k = &t->mesh[t->head.meshes++];
  k->point = old.points;
  k->edge = old.edges;
  k->face = old.faces;
  k->box = old.boxes;
  k->points = (int32_t)m->obj.point_count;
  k->edges = (int32_t)m->obj.edge_count;
  k->faces = (int32_t)m->obj.triangle_count;
  t->head.points += k->points;
  t->head.edges += k->edges;
  t->head.faces += k->faces;
  t->head.boxes += 2 * k->faces - 1;
  rigid_mesh_point *p = grown(t->points, t->head.points, sizeof *p);
  if (p != NULL) t->points = p;
  rigid_mesh_edge *e = grown(t->edges, t->head.edges, sizeof *e);
  if (e != NULL) t->edges = e;
  rigid_mesh_face *f = grown(t->faces, t->head.faces, sizeof *f);
  if (f != NULL) t->faces = f;
  rigid_mesh_box *b = grown(t->boxes, t->head.boxes, sizeof *b);
  if (b != NULL) t->boxes = b;
  return (p != NULL && e != NULL && f != NULL && b != NULL) || refuse(m, 0, "not enough memory");
}

static void store_vec(int32_t to[3], vec3 v) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

static int fill_tables(loading *m) {
  draft_rigid_meshes *t = &m->d->meshes;
  const rigid_mesh_entry *k = &t->mesh[t->head.meshes - 1];
  ranked *scratch = calloc(m->obj.triangle_count, sizeof *scratch);
  if (scratch == NULL) return refuse(m, 0, "not enough memory");
  for (uint32_t n = 0; n < m->obj.triangle_count; ++n) m->order[n] = n;
  (void)add_boxes(m, scratch, t->boxes + k->box, 0, 0, m->obj.triangle_count);
  free(scratch);
  for (uint32_t n = 0; n < m->obj.triangle_count; ++n) {
    const uint32_t triangle = m->order[n];
    rigid_mesh_face *f = &t->faces[k->face + (int32_t)n];
    m->face[triangle] = n;
    for (uint32_t c = 0; c < 3; ++c) f->point[c] = (int32_t)m->obj.triangles[triangle].point[c];
    store_vec(f->normal, m->normal[triangle]);
    f->owned_edges = 0;
    for (uint32_t c = 0; c < 3; ++c) t->points[k->point + f->point[c]].face = (int32_t)n;
  }
  for (uint32_t n = 0; n < m->obj.point_count; ++n) {
    store_vec(t->points[k->point + (int32_t)n].at, m->at[n]);
    t->points[k->point + (int32_t)n].sharp = 0;
  }
  for (uint32_t n = 0; n < m->obj.edge_count; ++n) {
    const obj_edge *from = &m->obj.edges[n];
    rigid_mesh_edge *e = &t->edges[k->edge + (int32_t)n];
    for (uint32_t c = 0; c < 2; ++c) {
      e->point[c] = (int32_t)from->point[c];
      e->face[c] = from->triangle[c] == OBJ_NONE ? RIGID_MESH_NONE : (int32_t)m->face[from->triangle[c]];
    }
    e->sharp = 0;
    rigid_mesh_face *f = &t->faces[k->face + e->face[0]];
    for (uint32_t c = 0; c < 3; ++c)
      if (f->point[c] == e->point[0]) f->owned_edges |= 1 << c;
  }
  return 1;
}

static int load(loading *m, uint32_t n) {
  draft_rigid_meshes *t = &m->d->meshes;
  if (!find_file(m) || !obj_load(m->file, &m->obj, m->d->error)) return 0;
  m->at = calloc(m->obj.point_count, sizeof *m->at);
  m->normal = calloc(m->obj.triangle_count, sizeof *m->normal);
  m->order = calloc(m->obj.triangle_count, sizeof *m->order);
  m->face = calloc(m->obj.triangle_count, sizeof *m->face);
  if (m->at == NULL || m->normal == NULL || m->order == NULL || m->face == NULL)
    return refuse(m, 0, "not enough memory");
  for (uint32_t p = 0; p < m->obj.point_count; ++p)
    if (!place_point(m, p)) return 0;
  if (!check_apart(m) || !check_triangles(m) || !check_outside(m) || !reserve(m) || !fill_tables(m))
    return 0;
  rigid_mesh_entry *k = &t->mesh[t->head.meshes - 1];
  k->body = (int32_t)n;
  const rigid_mesh_box *all = &t->boxes[k->box];
  for (uint32_t a = 0; a < 3; ++a) m->k->aabb_half[a] = fx_max(-all->low[a], all->high[a]);
  for (uint32_t a = 0; a < 9; ++a) m->k->axes[a] = a % 4 == 0 ? 1 << 30 : 0;
  return draft_find_sharp_edges(m->d, m->b, m->file, &m->obj);
}

/* An error of the file says which key of the scene named it. */
static int name_scene(const loading *m) {
  scene_error *e = m->d->error;
  char where[32] = "";
  if (strcmp(e->file, m->file) != 0) return 0;
  if (e->line > 0 && e->column > 0)
    snprintf(where, sizeof where, ":%d:%d", e->line, e->column);
  else if (e->line > 0)
    snprintf(where, sizeof where, ":%d", e->line);
  const scene_error inside = *e;
  return draft_refuse(m->d, source_place(&m->d->scene->source, BLOCK_BODY + m->n, "obj"),
                      "mesh '%s': %s%s: %s", m->b->name, m->file, where, inside.message);
}

int draft_rigid_mesh_load(draft *d, uint32_t n) {
  loading m;
  memset(&m, 0, sizeof m);
  m.d = d;
  m.n = n;
  m.b = &d->scene->bodies[n];
  m.k = &d->body[n];
  const int good = load(&m, n) || name_scene(&m);
  obj_free(&m.obj);
  free(m.at);
  free(m.normal);
  free(m.order);
  free(m.face);
  return good;
}

uint32_t draft_rigid_mesh_words(const draft *d) {
  const rigid_mesh_head *h = &d->meshes.head;
  if (h->meshes == 0 && h->meets_triangles == 0) return 0;
  return (uint32_t)(RIGID_MESH_HEAD_WORDS + h->meshes * RIGID_MESH_WORDS +
                    h->points * RIGID_MESH_POINT_WORDS + h->edges * RIGID_MESH_EDGE_WORDS +
                    h->faces * RIGID_MESH_FACE_WORDS + h->boxes * RIGID_MESH_BOX_WORDS);
}

static int32_t *put(int32_t *words, const void *table, int32_t count, size_t size) {
  if (count > 0) memcpy(words, table, (size_t)count * size);
  return words + (size_t)count * size / 4;
}

void draft_rigid_mesh_fill(const draft *d, int32_t *words) {
  const draft_rigid_meshes *t = &d->meshes;
  if (t->head.meshes == 0 && t->head.meets_triangles == 0) return;
  words = put(words, &t->head, 1, sizeof t->head);
  words = put(words, t->mesh, t->head.meshes, sizeof t->mesh[0]);
  words = put(words, t->points, t->head.points, sizeof t->points[0]);
  words = put(words, t->edges, t->head.edges, sizeof t->edges[0]);
  words = put(words, t->faces, t->head.faces, sizeof t->faces[0]);
  (void)put(words, t->boxes, t->head.boxes, sizeof t->boxes[0]);
}
