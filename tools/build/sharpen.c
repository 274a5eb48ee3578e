/* SPDX-License-Identifier: Apache-2.0 */
/* Which edges and points of a mesh cut. By angle: an edge whose faces meet outside at no more than the
 * angle, and a border; a point that sticks out and any two edges of which stand no farther apart. By
 * name: what the file marks with l and p. */
#include <stdlib.h>

#include "tools/build/draft.h"
#include "tools/build/obj.h"

enum { SLACK = 1 << 8 }; /* Q30: a right angle is one in spite of rounding */

typedef struct {
  mesh_point *points;
  mesh_edge *edges;
  const mesh_face *faces;
  uint32_t point_count, edge_count;
  int32_t cosine; /* of the angle, Q30 */
} parts;

static int sharpen_marks(const draft *d, const char *file, const obj_mesh *obj, const parts *m) {
  for (uint32_t n = 0; n < obj->mark_count; ++n) {
    const obj_mark *mark = &obj->marks[n];
    if (mark->point[0] == mark->point[1]) {
      m->points[mark->point[0]].sharp = 1;
      continue;
    }
    const uint32_t e = obj_edge_between(obj, mark->point[0], mark->point[1]);
    if (e == OBJ_NONE)
      return obj_refuse(d->error, file, mark->line, 0,
                        "found a line from point %u to point %u, expected one along an edge of a face",
                        mark->point[0] + 1, mark->point[1] + 1);
    m->edges[e].sharp = 1;
  }
  return 1;
}

static vec3 at(const parts *m, int32_t point) { return mesh_vec(m->points[point].at); }

static int edge_is_sharp(const parts *m, const mesh_edge *e) {
  if (e->face[1] == MESH_NONE) return 1;
  const vec3 first = mesh_vec(m->faces[e->face[0]].normal);
  const mesh_face *f = &m->faces[e->face[1]];
  int32_t other = f->point[0];
  for (uint32_t k = 1; k < 3; ++k)
    if (f->point[k] != e->point[0] && f->point[k] != e->point[1]) other = f->point[k];
  const int sticks_out = vec_dot_unit(vec_sub(at(m, other), at(m, e->point[0])), first) < 0;
  return sticks_out && vec_dot_unit(first, mesh_vec(f->normal)) <= SLACK - m->cosine;
}

static vec3 unit_between(const parts *m, int32_t from, int32_t to) {
  const vec3 way = vec_sub(at(m, to), at(m, from));
  const fx_root root = fx_rsqrt(vec_squared(way), FX_ROOT_FINE);
  return vec_make(fx_root_unit(root, way.x), fx_root_unit(root, way.y), fx_root_unit(root, way.z));
}

/* The edges of a point, as a list: first[point], then next[2 * edge + end]; UINT32_MAX ends it. */
typedef struct {
  uint32_t *first, *next;
} around;

static vec3 leaves(const parts *m, uint32_t end) {
  const mesh_edge *e = &m->edges[end / 2];
  return unit_between(m, e->point[end % 2], e->point[(end + 1) % 2]);
}

static int point_is_sharp(const parts *m, const around *a, uint32_t point) {
  int64_t out = 0; /* how far the edges go against the normals of their faces */
  for (uint32_t n = a->first[point]; n != UINT32_MAX; n = a->next[n]) {
    const vec3 u = leaves(m, n);
    for (uint32_t k = a->next[n]; k != UINT32_MAX; k = a->next[k])
      if (vec_dot_unit(u, leaves(m, k)) < m->cosine - SLACK) return 0;
    for (uint32_t k = a->first[point]; k != UINT32_MAX; k = a->next[k])
      out += fx_asr(vec_dot_unit(u, mesh_vec(m->faces[m->edges[k / 2].face[0]].normal)), 16);
  }
  return out <= 0;
}

static int sharpen_points(const parts *m) {
  around a = {malloc(m->point_count * sizeof *a.first), malloc(2u * m->edge_count * sizeof *a.next)};
  const int good = a.first != NULL && a.next != NULL;
  for (uint32_t n = 0; n < m->point_count && good; ++n) a.first[n] = UINT32_MAX;
  for (uint32_t n = 0; n < 2 * m->edge_count && good; ++n) {
    const int32_t point = m->edges[n / 2].point[n % 2];
    a.next[n] = a.first[point];
    a.first[point] = n;
  }
  for (uint32_t n = 0; n < m->point_count && good; ++n)
    m->points[n].sharp = point_is_sharp(m, &a, n);
  free(a.first);
  free(a.next);
  return good;
}

/* (1 - t^2) / (1 + t^2) */
static int cosine_of(exact t, int32_t *cosine) {
  const exact one = exact_make(1, 1);
  const exact t2 = exact_mul(t, t);
  int64_t fixed;
  if (!exact_to_fixed(exact_div(exact_sub(one, t2), exact_add(one, t2)), 30, &fixed)) return 0;
  *cosine = (int32_t)fixed;
  return 1;
}

int draft_mesh_sharpen(const draft *d, const scene_body *b, const char *file, const obj_mesh *obj) {
  const draft_mesh *t = &d->meshes;
  const mesh_entry *k = &t->mesh[t->head.meshes - 1];
  parts m = {t->points + k->point, t->edges + k->edge, t->faces + k->face, obj->point_count,
             obj->edge_count, 0};
  if (b->sharp == SCENE_SHARP_OFF) return 1;
  if (b->sharp == SCENE_SHARP_NAMED) return sharpen_marks(d, file, obj, &m);
  if (!cosine_of(b->sharp_tangent, &m.cosine))
    return draft_refuse(d, b->line, "sharp: an angle that cannot be held");
  for (uint32_t n = 0; n < m.edge_count; ++n) m.edges[n].sharp = edge_is_sharp(&m, &m.edges[n]);
  return sharpen_points(&m) || draft_refuse(d, b->line, "not enough memory");
}
