/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/state/rigid_mesh.h"

static const rigid_mesh_head *head_of(const fray_world *w) {
  return (const rigid_mesh_head *)(const void *)w->rigid.mesh_words;
}
static const rigid_mesh_entry *table_of(const fray_world *w) {
  return (const rigid_mesh_entry *)(const void *)(w->rigid.mesh_words + RIGID_MESH_HEAD_WORDS);
}

uint32_t rigid_mesh_count(const fray_world *w) {
  return world_has_rigid_meshes(w) ? (uint32_t)head_of(w)->meshes : 0;
}

int rigid_mesh_meets_triangles(const fray_world *w) {
  return world_has_rigid_meshes(w) && world_has_membrane(w) && head_of(w)->meets_triangles != 0;
}

uint32_t collider_count(const fray_world *w) {
  uint32_t count = rigid_mesh_count(w);
  for (uint32_t b = 0; b < w->capacity[POOL_BODIES]; ++b)
    count += body_is_sphere_collider(&w->rigid.bodies[b]) && rigid_mesh_meets_triangles(w);
  return count;
}

rigid_mesh_parts rigid_mesh_at(const fray_world *w, uint32_t n) {
  FRAY_ASSERT(n < rigid_mesh_count(w));
  const rigid_mesh_head *h = head_of(w);
  const rigid_mesh_entry *k = &table_of(w)[n];
  const int32_t *points = w->rigid.mesh_words + RIGID_MESH_HEAD_WORDS + h->meshes * RIGID_MESH_WORDS;
  const int32_t *edges = points + h->points * RIGID_MESH_POINT_WORDS;
  const int32_t *faces = edges + h->edges * RIGID_MESH_EDGE_WORDS;
  const int32_t *boxes = faces + h->faces * RIGID_MESH_FACE_WORDS;
  const rigid_mesh_parts parts = {k,
                            (const rigid_mesh_point *)(const void *)points + k->point,
                            (const rigid_mesh_edge *)(const void *)edges + k->edge,
                            (const rigid_mesh_face *)(const void *)faces + k->face,
                            (const rigid_mesh_box *)(const void *)boxes + k->box,
                            2u * (uint32_t)k->faces - 1u};
  return parts;
}

uint32_t rigid_mesh_of_body(const fray_world *w, uint32_t b) {
  FRAY_ASSERT(b < w->capacity[POOL_BODIES]);
  const uint32_t count = rigid_mesh_count(w);
  for (uint32_t n = 0; n < count; ++n)
    if ((uint32_t)table_of(w)[n].body == b) return n;
  return count;
}

static uint64_t magnitude_bits(int64_t v) { return (uint64_t)(v ^ fx_asr64(v, 63)); }

vec3 rigid_mesh_normal(vec3 a, vec3 b, vec3 c) {
  const vec64 n = vec_cross64(vec_sub(b, a), vec_sub(c, a)); /* of edges below 2^30: below 2^61 */
  const uint64_t span = magnitude_bits(n.x) | magnitude_bits(n.y) | magnitude_bits(n.z) | 1u;
  const unsigned width = 64u - fx_leading_zeros64(span);
  return vec_unit(width > 30u ? vec_round64(n, width - 30u) : vec_asr64(n, 0), vec_make(0, 0, 0));
}

int rigid_mesh_is_sharp(const fray_world *w, uint32_t n) {
  FRAY_ASSERT(n < rigid_mesh_count(w));
  const rigid_mesh_parts m = rigid_mesh_at(w, n);
  int32_t sharp = 0;
  for (uint32_t p = 0; p < (uint32_t)m.of->points; ++p) sharp |= m.points[p].sharp;
  for (uint32_t e = 0; e < (uint32_t)m.of->edges; ++e) sharp |= m.edges[e].sharp;
  return sharp != 0;
}

int rigid_mesh_edge_is_sharp(const rigid_mesh_parts *m, const rigid_mesh_face *face, uint32_t k) {
  FRAY_ASSERT(k < 3);
  const int32_t a = face->point[k];
  const int32_t b = face->point[k == 2 ? 0 : k + 1u];
  const int32_t low = fx_min(a, b);
  const int32_t high = fx_max(a, b);
  uint32_t first = 0;
  uint32_t end = (uint32_t)m->of->edges;
  while (first < end) {
    const uint32_t middle = first + (end - first) / 2u;
    const int32_t *ends = m->edges[middle].point;
    const int32_t least = fx_min(ends[0], ends[1]);
    const int32_t most = fx_max(ends[0], ends[1]);
    if (least == low && most == high) return m->edges[middle].sharp;
    if (least < low || (least == low && most < high))
      first = middle + 1u;
    else
      end = middle;
  }
  return 0;
}

int32_t rigid_mesh_extent(const rigid_mesh_parts *m, vec3 along) {
  int32_t most = 0;
  for (uint32_t n = 0; n < (uint32_t)m->of->points; ++n)
    most = fx_max(most, vec_dot_unit(vec_of(m->points[n].at), along));
  return most;
}

/* Tables follow one another and fill their section; after this check indices of tables can be used. */
static const char *tables_error(const fray_world *w) {
  const rigid_mesh_head *h = head_of(w);
  const uint64_t all = w->capacity[POOL_RIGID_MESH_WORDS];
  if (all < RIGID_MESH_HEAD_WORDS || h->meshes < 0 || h->meshes > MAX_BODIES ||
      (h->meets_triangles | 1) != 1 || h->meshes + h->meets_triangles == 0 ||
      (h->meets_triangles != 0 && !world_has_membrane(w)) || h->points < 0 || h->points > MAX_MESH_POINTS ||
      h->edges < 0 || h->edges > 2 * MAX_MESH_FACES || h->faces < 0 || h->faces > MAX_MESH_FACES ||
      h->boxes < 0 || h->boxes > 2 * MAX_MESH_FACES)
    return "counts of meshes in their ranges";
  const uint64_t words = (uint64_t)RIGID_MESH_HEAD_WORDS + (uint64_t)h->meshes * RIGID_MESH_WORDS +
                         (uint64_t)h->points * RIGID_MESH_POINT_WORDS +
                         (uint64_t)h->edges * RIGID_MESH_EDGE_WORDS +
                         (uint64_t)h->faces * RIGID_MESH_FACE_WORDS +
                         (uint64_t)h->boxes * RIGID_MESH_BOX_WORDS;
  if (words != all) return "tables of meshes that fill their section";
  int32_t point = 0;
  int32_t edge = 0;
  int32_t face = 0;
  int32_t box = 0;
  for (int32_t n = 0; n < h->meshes; ++n) {
    const rigid_mesh_entry *k = &table_of(w)[n];
    if (k->point != point || k->edge != edge || k->face != face || k->box != box || k->points < 3 ||
        k->points > h->points - point || k->edges < 3 || k->edges > h->edges - edge || k->faces < 1 ||
        k->faces > h->faces - face || 2 * k->faces - 1 > h->boxes - box)
      return "meshes without gaps or overlap";
    point += k->points;
    edge += k->edges;
    face += k->faces;
    box += 2 * k->faces - 1;
  }
  if (point != h->points || edge != h->edges || face != h->faces || box != h->boxes)
    return "meshes that have all points, edges, faces and boxes";
  return NULL;
}

static int bodies_are_valid(const fray_world *w) {
  uint32_t n = 0;
  for (uint32_t b = 0; b < w->capacity[POOL_BODIES]; ++b) {
    if (!body_is_mesh(&w->rigid.bodies[b])) continue;
    if (n == rigid_mesh_count(w) || (uint32_t)table_of(w)[n].body != b) return 0;
    ++n;
  }
  return n == rigid_mesh_count(w);
}

static int is_index(int32_t n, int32_t count) { return n >= 0 && n < count; }

static int points_are_valid(const rigid_mesh_parts *m) {
  for (int32_t n = 0; n < m->of->points; ++n) {
    const rigid_mesh_point *p = &m->points[n];
    if (!vec_is_within(vec_of(p->at), RIGID_MESH_REACH_MAX) || (p->sharp | 1) != 1) return 0;
  }
  return 1;
}

static int faces_are_valid(const rigid_mesh_parts *m) {
  for (int32_t n = 0; n < m->of->faces; ++n) {
    const int32_t *p = m->faces[n].point;
    for (uint32_t k = 0; k < 3; ++k)
      if (!is_index(p[k], m->of->points) || p[k] == p[(k + 1u) % 3u]) return 0;
    const uint32_t face = (uint32_t)n;
    const vec3 made = rigid_mesh_normal(rigid_mesh_corner(m, face, 0), rigid_mesh_corner(m, face, 1),
                                        rigid_mesh_corner(m, face, 2));
    if (!vec_is_equal(made, vec_of(m->faces[n].normal)) || vec_squared(made) == 0) return 0;
  }
  return 1;
}

/* The face has an edge from one point to the other. */
static int has_edge(const rigid_mesh_face *f, int32_t from, int32_t to) {
  for (uint32_t k = 0; k < 3; ++k)
    if (f->point[k] == from && f->point[(k + 1u) % 3u] == to) return 1;
  return 0;
}

/* As each pair of points occurs once, and each side of a face is part of at most one edge, it is enough
 * that the numbers of sides agree. */
static int edges_are_valid(const rigid_mesh_parts *m) {
  int32_t sides = 0;
  int32_t low = -1;
  int32_t high = -1;
  for (int32_t n = 0; n < m->of->edges; ++n) {
    const rigid_mesh_edge *e = &m->edges[n];
    if (!is_index(e->point[0], m->of->points) || !is_index(e->point[1], m->of->points) ||
        !is_index(e->face[0], m->of->faces) ||
        (e->face[1] != RIGID_MESH_NONE && !is_index(e->face[1], m->of->faces)) || (e->sharp | 1) != 1)
      return 0;
    if (!has_edge(&m->faces[e->face[0]], e->point[0], e->point[1]) ||
        (e->face[1] != RIGID_MESH_NONE && !has_edge(&m->faces[e->face[1]], e->point[1], e->point[0])))
      return 0;
    const int32_t lesser = fx_min(e->point[0], e->point[1]);
    const int32_t other = fx_max(e->point[0], e->point[1]);
    if (lesser < low || (lesser == low && other <= high)) return 0;
    low = lesser;
    high = other;
    sides += e->face[1] == RIGID_MESH_NONE ? 1 : 2;
  }
  return sides == 3 * m->of->faces;
}

static int box_contains(const rigid_mesh_box *b, const int32_t low[3], const int32_t high[3]) {
  for (uint32_t k = 0; k < 3; ++k)
    if (b->low[k] > low[k] || b->high[k] < high[k] || b->low[k] < -RIGID_MESH_REACH_MAX ||
        b->high[k] > RIGID_MESH_REACH_MAX)
      return 0;
  return 1;
}

/* Every edge and every point is owned by one face: as many bits as edges, one for each. */
static int owners_are_valid(const rigid_mesh_parts *m) {
  int32_t sides = 0;
  for (int32_t n = 0; n < m->of->faces; ++n) {
    const int32_t own = m->faces[n].owned_edges;
    if (own < 0 || own > 7) return 0;
    for (uint32_t k = 0; k < 3; ++k) sides += own >> k & 1;
  }
  for (int32_t n = 0; n < m->of->edges; ++n) {
    const rigid_mesh_face *f = &m->faces[m->edges[n].face[0]];
    for (uint32_t k = 0; k < 3; ++k)
      if (f->point[k] == m->edges[n].point[0] && (f->owned_edges >> k & 1) == 0) return 0;
  }
  for (int32_t n = 0; n < m->of->points; ++n) {
    if (!is_index(m->points[n].face, m->of->faces)) return 0;
    const int32_t *p = m->faces[m->points[n].face].point;
    if (p[0] != n && p[1] != n && p[2] != n) return 0;
  }
  return sides == m->of->edges;
}

/* From the last box to the first, so that children are checked before their parent. */
static int boxes_are_valid(const rigid_mesh_parts *m) {
  const int32_t count = (int32_t)m->box_count;
  int32_t face = m->of->faces;
  for (int32_t n = count - 1; n >= 0; --n) {
    const rigid_mesh_box *b = &m->boxes[n];
    if (b->face == RIGID_MESH_NONE) {
      if (n + 2 >= count) return 0;
      const rigid_mesh_box *first = &m->boxes[n + 1];
      if (first->next >= count) return 0;
      const rigid_mesh_box *second = &m->boxes[first->next];
      if (b->next != second->next || !box_contains(b, first->low, first->high) ||
          !box_contains(b, second->low, second->high))
        return 0;
    } else {
      if (b->face != --face || face < 0 || b->next != n + 1) return 0;
      for (uint32_t k = 0; k < 3; ++k) {
        const int32_t *at = m->points[m->faces[face].point[k]].at;
        if (!box_contains(b, at, at)) return 0;
      }
    }
  }
  return face == 0 && m->boxes[0].next == count;
}

const char *rigid_mesh_error(const fray_world *w) {
  const char *error = tables_error(w);
  if (error != NULL) return error;
  if (!bodies_are_valid(w)) return "a mesh for each body that is one, in their order";
  for (uint32_t n = 0; n < rigid_mesh_count(w); ++n) {
    const rigid_mesh_parts m = rigid_mesh_at(w, n);
    if (!points_are_valid(&m)) return "points within 16 lu";
    if (!faces_are_valid(&m)) return "faces with an area, three points that exist and their normal";
    if (!edges_are_valid(&m)) return "edges that join the sides of faces";
    if (!owners_are_valid(&m)) return "sides and points that have a face";
    if (!boxes_are_valid(&m)) return "a tree of boxes around every face";
  }
  return NULL;
}
