/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/model/mesh.h"

static const mesh_head *head_of(const fray_world *w) {
  return (const mesh_head *)(const void *)w->meshes;
}
static const mesh_entry *table_of(const fray_world *w) {
  return (const mesh_entry *)(const void *)(w->meshes + MESH_HEAD_WORDS);
}

uint32_t mesh_count(const fray_world *w) {
  return world_has_meshes(w) ? (uint32_t)head_of(w)->meshes : 0;
}

int mesh_is_whole(const fray_world *w) {
  return world_has_meshes(w) && world_has_sheet(w) && head_of(w)->whole != 0;
}

uint32_t mesh_solids(const fray_world *w) {
  uint32_t count = mesh_count(w);
  for (uint32_t b = 0; b < w->capacity[POOL_BODIES]; ++b)
    count += w->bodies[b].shape == FRAY_BALL && mesh_is_whole(w);
  return count;
}

mesh_parts mesh_at(const fray_world *w, uint32_t n) {
  const mesh_head *h = head_of(w);
  const mesh_entry *k = &table_of(w)[n];
  const int32_t *points = w->meshes + MESH_HEAD_WORDS + h->meshes * MESH_WORDS;
  const int32_t *edges = points + h->points * MESH_POINT_WORDS;
  const int32_t *faces = edges + h->edges * MESH_EDGE_WORDS;
  const int32_t *boxes = faces + h->faces * MESH_FACE_WORDS;
  const mesh_parts parts = {k,
                            (const mesh_point *)(const void *)points + k->point,
                            (const mesh_edge *)(const void *)edges + k->edge,
                            (const mesh_face *)(const void *)faces + k->face,
                            (const mesh_box *)(const void *)boxes + k->box,
                            2u * (uint32_t)k->faces - 1u};
  return parts;
}

uint32_t mesh_of_body(const fray_world *w, uint32_t b) {
  const uint32_t count = mesh_count(w);
  for (uint32_t n = 0; n < count; ++n)
    if ((uint32_t)table_of(w)[n].body == b) return n;
  return count;
}

/* a.x b.y - a.y b.x, of edges below 2^30: below 2^61. */
static int64_t minor_of(int32_t ax, int32_t ay, int32_t bx, int32_t by) {
  return fx_add64(fx_mul_wide(ax, by), -fx_mul_wide(ay, bx));
}
static uint64_t span64(int64_t v) { return (uint64_t)(v ^ fx_asr64(v, 63)); }

vec3 mesh_normal(vec3 a, vec3 b, vec3 c) {
  const vec3 u = vec_sub(b, a);
  const vec3 v = vec_sub(c, a);
  const int64_t n[3] = {minor_of(u.y, u.z, v.y, v.z), minor_of(u.z, u.x, v.z, v.x),
                        minor_of(u.x, u.y, v.x, v.y)};
  const uint64_t span = span64(n[0]) | span64(n[1]) | span64(n[2]) | 1u;
  const unsigned width = 64u - fx_leading_zeros64(span);
  const unsigned s = width > 30u ? width - 30u : 0;
  int32_t coarse[3];
  for (uint32_t k = 0; k < 3; ++k) coarse[k] = (int32_t)(s == 0 ? n[k] : fx_round64(n[k], s));
  const vec3 normal = mesh_vec(coarse);
  const uint64_t squared = vec_squared(normal);
  if (squared == 0) return vec_make(0, 0, 0);
  const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
  return vec_make(fx_root_unit(root, normal.x), fx_root_unit(root, normal.y),
                  fx_root_unit(root, normal.z));
}

int mesh_is_sharp(const fray_world *w, uint32_t n) {
  const mesh_parts m = mesh_at(w, n);
  int32_t sharp = 0;
  for (uint32_t p = 0; p < (uint32_t)m.of->points; ++p) sharp |= m.points[p].sharp;
  for (uint32_t e = 0; e < (uint32_t)m.of->edges; ++e) sharp |= m.edges[e].sharp;
  return sharp != 0;
}

int mesh_side_is_sharp(const mesh_parts *m, const mesh_face *face, uint32_t k) {
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

int32_t mesh_extent(const mesh_parts *m, vec3 along) {
  int32_t most = 0;
  for (uint32_t n = 0; n < (uint32_t)m->of->points; ++n)
    most = fx_max(most, vec_dot_unit(mesh_vec(m->points[n].at), along));
  return most;
}

/* Tables that lie one behind the other and fill their section; then ids can be followed. */
static const char *tables_wrong(const fray_world *w) {
  const mesh_head *h = head_of(w);
  const uint64_t all = w->capacity[POOL_MESH_WORDS];
  if (all < MESH_HEAD_WORDS || h->meshes < 0 || h->meshes > LIMIT_BODIES || (h->whole | 1) != 1 ||
      h->meshes + h->whole == 0 || (h->whole != 0 && !world_has_sheet(w)) || h->points < 0 ||
      h->points > LIMIT_MESH_POINTS || h->edges < 0 || h->edges > 2 * LIMIT_MESH_FACES ||
      h->faces < 0 || h->faces > LIMIT_MESH_FACES || h->boxes < 0 || h->boxes > 2 * LIMIT_MESH_FACES)
    return "counts of meshes in their ranges";
  const uint64_t words = (uint64_t)MESH_HEAD_WORDS + (uint64_t)h->meshes * MESH_WORDS +
                         (uint64_t)h->points * MESH_POINT_WORDS +
                         (uint64_t)h->edges * MESH_EDGE_WORDS +
                         (uint64_t)h->faces * MESH_FACE_WORDS + (uint64_t)h->boxes * MESH_BOX_WORDS;
  if (words != all) return "tables of meshes that fill their section";
  int32_t point = 0;
  int32_t edge = 0;
  int32_t face = 0;
  int32_t box = 0;
  for (int32_t n = 0; n < h->meshes; ++n) {
    const mesh_entry *k = &table_of(w)[n];
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

static int bodies_match(const fray_world *w) {
  uint32_t n = 0;
  for (uint32_t b = 0; b < w->capacity[POOL_BODIES]; ++b) {
    if (w->bodies[b].shape != FRAY_MESH) continue;
    if (n == mesh_count(w) || (uint32_t)table_of(w)[n].body != b) return 0;
    ++n;
  }
  return n == mesh_count(w);
}

static int in_list(int32_t n, int32_t count) { return n >= 0 && n < count; }

static int points_good(const mesh_parts *m) {
  for (int32_t n = 0; n < m->of->points; ++n) {
    const mesh_point *p = &m->points[n];
    for (uint32_t k = 0; k < 3; ++k)
      if (p->at[k] < -MESH_REACH_MAX || p->at[k] > MESH_REACH_MAX) return 0;
    if ((p->sharp | 1) != 1) return 0;
  }
  return 1;
}

static int faces_good(const mesh_parts *m) {
  for (int32_t n = 0; n < m->of->faces; ++n) {
    const int32_t *p = m->faces[n].point;
    const int32_t *normal = m->faces[n].normal;
    for (uint32_t k = 0; k < 3; ++k)
      if (!in_list(p[k], m->of->points) || p[k] == p[(k + 1u) % 3u]) return 0;
    const uint32_t face = (uint32_t)n;
    const vec3 made =
        mesh_normal(mesh_corner(m, face, 0), mesh_corner(m, face, 1), mesh_corner(m, face, 2));
    if (made.x != normal[0] || made.y != normal[1] || made.z != normal[2] || vec_squared(made) == 0)
      return 0;
  }
  return 1;
}

/* The face has a side from one point to the other. */
static int passes_side(const mesh_face *f, int32_t from, int32_t to) {
  for (uint32_t k = 0; k < 3; ++k)
    if (f->point[k] == from && f->point[(k + 1u) % 3u] == to) return 1;
  return 0;
}

/* As each pair of points comes once, and each side of a face is in at most one edge, it is enough that
 * the sides add up. */
static int edges_good(const mesh_parts *m) {
  int32_t sides = 0;
  int32_t low = -1;
  int32_t high = -1;
  for (int32_t n = 0; n < m->of->edges; ++n) {
    const mesh_edge *e = &m->edges[n];
    if (!in_list(e->point[0], m->of->points) || !in_list(e->point[1], m->of->points) ||
        !in_list(e->face[0], m->of->faces) ||
        (e->face[1] != MESH_NONE && !in_list(e->face[1], m->of->faces)) || (e->sharp | 1) != 1)
      return 0;
    if (!passes_side(&m->faces[e->face[0]], e->point[0], e->point[1]) ||
        (e->face[1] != MESH_NONE && !passes_side(&m->faces[e->face[1]], e->point[1], e->point[0])))
      return 0;
    const int32_t lesser = fx_min(e->point[0], e->point[1]);
    const int32_t other = fx_max(e->point[0], e->point[1]);
    if (lesser < low || (lesser == low && other <= high)) return 0;
    low = lesser;
    high = other;
    sides += e->face[1] == MESH_NONE ? 1 : 2;
  }
  return sides == 3 * m->of->faces;
}

static int box_holds(const mesh_box *b, const int32_t low[3], const int32_t high[3]) {
  for (uint32_t k = 0; k < 3; ++k)
    if (b->low[k] > low[k] || b->high[k] < high[k] || b->low[k] < -MESH_REACH_MAX ||
        b->high[k] > MESH_REACH_MAX)
      return 0;
  return 1;
}

/* As many bits as edges, one for each. */
static int owners_good(const mesh_parts *m) {
  int32_t sides = 0;
  for (int32_t n = 0; n < m->of->faces; ++n) {
    const int32_t own = m->faces[n].own;
    if (own < 0 || own > 7) return 0;
    for (uint32_t k = 0; k < 3; ++k) sides += own >> k & 1;
  }
  for (int32_t n = 0; n < m->of->edges; ++n) {
    const mesh_face *f = &m->faces[m->edges[n].face[0]];
    for (uint32_t k = 0; k < 3; ++k)
      if (f->point[k] == m->edges[n].point[0] && (f->own >> k & 1) == 0) return 0;
  }
  for (int32_t n = 0; n < m->of->points; ++n) {
    if (!in_list(m->points[n].face, m->of->faces)) return 0;
    const int32_t *p = m->faces[m->points[n].face].point;
    if (p[0] != n && p[1] != n && p[2] != n) return 0;
  }
  return sides == m->of->edges;
}

/* From the last box on: children are known to be good when their parent is looked at. */
static int boxes_good(const mesh_parts *m) {
  const int32_t count = (int32_t)m->box_count;
  int32_t face = m->of->faces;
  for (int32_t n = count - 1; n >= 0; --n) {
    const mesh_box *b = &m->boxes[n];
    if (b->face == MESH_NONE) {
      if (n + 2 >= count) return 0;
      const mesh_box *first = &m->boxes[n + 1];
      if (first->next >= count) return 0;
      const mesh_box *second = &m->boxes[first->next];
      if (b->next != second->next || !box_holds(b, first->low, first->high) ||
          !box_holds(b, second->low, second->high))
        return 0;
    } else {
      if (b->face != --face || face < 0 || b->next != n + 1) return 0;
      for (uint32_t k = 0; k < 3; ++k) {
        const int32_t *at = m->points[m->faces[face].point[k]].at;
        if (!box_holds(b, at, at)) return 0;
      }
    }
  }
  return face == 0 && m->boxes[0].next == count;
}

const char *mesh_wrong(const fray_world *w) {
  const char *wrong = tables_wrong(w);
  if (wrong != NULL) return wrong;
  if (!bodies_match(w)) return "a mesh for each body that is one, in their order";
  for (uint32_t n = 0; n < mesh_count(w); ++n) {
    const mesh_parts m = mesh_at(w, n);
    if (!points_good(&m)) return "points within 16 lu";
    if (!faces_good(&m)) return "faces with an area, three points that exist and their normal";
    if (!edges_good(&m)) return "edges that join the sides of faces";
    if (!owners_good(&m)) return "sides and points that have a face";
    if (!boxes_good(&m)) return "a tree of boxes around every face";
  }
  return NULL;
}
