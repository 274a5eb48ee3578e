/* SPDX-License-Identifier: Apache-2.0 */
/* Sharp edges and points of a mesh, which cut. By angle: convex edges where the faces enclose no more than
 * the angle, border edges, and convex points with two edges that enclose no more. By name: those that the
 * file marks with l and p. */
#include <stdlib.h>

#include "tools/scene_compiler/draft.h"
#include "tools/mesh_import/obj.h"

enum { SLACK = 1 << 8 }; /* Q30: 90 degrees stay 90 degrees in spite of rounding */

typedef struct {
  rigid_mesh_point *points;
  rigid_mesh_edge *edges;
  const rigid_mesh_face *faces;
  uint32_t point_count, edge_count;
  int32_t cosine; /* of the angle, Q30 */
} parts;

static int sharpen_marks(const draft *d, const char *file, const obj_mesh *obj, const parts *m) {
  if (obj->mark_count == 0)
    return obj_refuse(d->error, file, 0, 0,
                      "found no edge or point that is marked, expected lines 'l a b' or 'p a' "
                      "for 'sharp named'");
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

static vec3 at(const parts *m, int32_t point) { return vec_of(m->points[point].at); }

static int edge_is_sharp(const parts *m, const rigid_mesh_edge *e) {
  if (e->face[1] == RIGID_MESH_NONE) return 1;
  const vec3 first = vec_of(m->faces[e->face[0]].normal);
  const rigid_mesh_face *f = &m->faces[e->face[1]];
  int32_t other = f->point[0];
  for (uint32_t k = 1; k < 3; ++k)
    if (f->point[k] != e->point[0] && f->point[k] != e->point[1]) other = f->point[k];
  const int sticks_out = vec_dot_unit(vec_sub(at(m, other), at(m, e->point[0])), first) < 0;
  return sticks_out && vec_dot_unit(first, vec_of(f->normal)) <= SLACK - m->cosine;
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
  const rigid_mesh_edge *e = &m->edges[end / 2];
  return unit_between(m, e->point[end % 2], e->point[(end + 1) % 2]);
}

static int point_is_sharp(const parts *m, const around *a, uint32_t point) {
  int64_t out = 0; /* sum of the edges along the normals of their faces */
  for (uint32_t n = a->first[point]; n != UINT32_MAX; n = a->next[n]) {
    const vec3 u = leaves(m, n);
    for (uint32_t k = a->next[n]; k != UINT32_MAX; k = a->next[k])
      if (vec_dot_unit(u, leaves(m, k)) < m->cosine - SLACK) return 0;
    for (uint32_t k = a->first[point]; k != UINT32_MAX; k = a->next[k])
      out += fx_asr(vec_dot_unit(u, vec_of(m->faces[m->edges[k / 2].face[0]].normal)), 16);
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

int draft_find_sharp_edges(const draft *d, const scene_body *b, const char *file, const obj_mesh *obj) {
  const draft_rigid_meshes *t = &d->meshes;
  const rigid_mesh_entry *k = &t->mesh[t->head.meshes - 1];
  parts m = {t->points + k->point, t->edges + k->edge, t->faces + k->face, obj->point_count,
             obj->edge_count, 0};
  if (b->sharp == SCENE_SHARP_OFF) return 1;
  if (b->sharp == SCENE_SHARP_NAMED) return sharpen_marks(d, file, obj, &m);
  if (!cosine_of(b->sharp_tangent, &m.cosine))
    return draft_expected(d, BLOCK_BODY + (uint32_t)(b - d->scene->bodies), "sharp",
                          "an angle of fewer digits");
  for (uint32_t n = 0; n < m.edge_count; ++n) m.edges[n].sharp = edge_is_sharp(&m, &m.edges[n]);
  return sharpen_points(&m) || draft_no_memory(d);
}
