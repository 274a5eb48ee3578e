/* SPDX-License-Identifier: Apache-2.0 */
/* Sides of triangles become edges by sorting; corners that meet along an edge are one fan. */
#include <stdlib.h>

#include "tools/mesh_import/obj.h"

/* A side of a triangle, by its lesser point; `back` where it goes from the larger to the lesser. */
typedef struct {
  uint32_t low, high, back, triangle;
} side;

static int compare_words(const uint32_t *a, const uint32_t *b, int count) {
  for (int n = 0; n < count; ++n)
    if (a[n] != b[n]) return a[n] < b[n] ? -1 : 1;
  return 0;
}
static int compare_sides(const void *left, const void *right) {
  const side *l = left;
  const side *r = right;
  const uint32_t a[4] = {l->low, l->high, l->back, l->triangle};
  const uint32_t b[4] = {r->low, r->high, r->back, r->triangle};
  return compare_words(a, b, 4);
}

static side *sorted_sides(const obj_mesh *m) {
  side *sides = calloc((size_t)m->triangle_count * 3u, sizeof *sides);
  if (sides == NULL) return NULL;
  for (uint32_t t = 0; t < m->triangle_count; ++t)
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t from = m->triangles[t].point[k];
      const uint32_t to = m->triangles[t].point[(k + 1) % 3];
      const side s = {from < to ? from : to, from < to ? to : from, from > to, t};
      sides[3 * t + k] = s;
    }
  qsort(sides, (size_t)m->triangle_count * 3u, sizeof *sides, compare_sides);
  return sides;
}

static int later(const obj_mesh *m, const side *sides, uint32_t count) {
  int line = 0;
  for (uint32_t n = 0; n < count; ++n) {
    const int own = m->triangles[sides[n].triangle].line;
    if (own > line) line = own;
  }
  return line;
}

/* `count` sides between the same two points. */
static int add_edge(const char *file, obj_mesh *m, const side *sides, uint32_t count,
                    scene_error *error) {
  const int line = later(m, sides, count);
  if (count > 2)
    return obj_refuse(error, file, line, 0,
                      "found %u triangles at the edge of points %u and %u, expected at most 2", count,
                      sides[0].low + 1, sides[0].high + 1);
  if (count == 2 && sides[0].back == sides[1].back)
    return obj_refuse(error, file, line, 0,
                      "found two triangles that pass the edge of points %u and %u in the same direction, "
                      "expected all faces anticlockwise as seen from outside",
                      sides[0].low + 1, sides[0].high + 1);
  const uint32_t back = sides[0].back;
  const obj_edge edge = {{back ? sides[0].high : sides[0].low, back ? sides[0].low : sides[0].high},
                         {sides[0].triangle, count == 2 ? sides[1].triangle : OBJ_NONE}};
  m->edges[m->edge_count++] = edge;
  return 1;
}

static int add_edges(const char *file, obj_mesh *m, const side *sides, scene_error *error) {
  const uint32_t all = m->triangle_count * 3u;
  for (uint32_t n = 0; n < all;) {
    uint32_t end = n + 1;
    while (end < all && sides[end].low == sides[n].low && sides[end].high == sides[n].high) ++end;
    if (!add_edge(file, m, &sides[n], end - n, error)) return 0;
    n = end;
  }
  return 1;
}

static uint32_t corner_of(const obj_mesh *m, uint32_t triangle, uint32_t point) {
  const uint32_t *p = m->triangles[triangle].point;
  return 3 * triangle + (p[0] == point ? 0u : p[1] == point ? 1u : 2u);
}
static uint32_t root_of(uint32_t *parent, uint32_t n) {
  while (parent[n] != n) n = parent[n] = parent[parent[n]];
  return n;
}

static int check_fans(const char *file, const obj_mesh *m, uint32_t *parent, uint32_t *fan,
                      scene_error *error) {
  const uint32_t corners = m->triangle_count * 3u;
  for (uint32_t n = 0; n < corners; ++n) parent[n] = n;
  for (uint32_t n = 0; n < m->point_count; ++n) fan[n] = OBJ_NONE;
  for (uint32_t e = 0; e < m->edge_count; ++e) {
    const obj_edge *edge = &m->edges[e];
    for (uint32_t k = 0; k < 2 && edge->triangle[1] != OBJ_NONE; ++k) {
      const uint32_t a = root_of(parent, corner_of(m, edge->triangle[0], edge->point[k]));
      const uint32_t b = root_of(parent, corner_of(m, edge->triangle[1], edge->point[k]));
      if (a < b)
        parent[b] = a;
      else
        parent[a] = b;
    }
  }
  for (uint32_t n = 0; n < corners; ++n) {
    const uint32_t point = m->triangles[n / 3].point[n % 3];
    const uint32_t root = root_of(parent, n);
    if (fan[point] == OBJ_NONE) fan[point] = root;
    if (fan[point] != root)
      return obj_refuse(error, file, m->triangles[n / 3].line, 0,
                        "found triangles at point %u that only touch there, expected them to share "
                        "edges around it",
                        point + 1);
  }
  for (uint32_t n = 0; n < m->point_count; ++n)
    if (fan[n] == OBJ_NONE)
      return obj_refuse(error, file, m->points[n].line, 0,
                        "found point %u in no face, expected one or no such point", n + 1);
  return 1;
}

int obj_join(const char *file, obj_mesh *m, scene_error *error) {
  const size_t corners = (size_t)m->triangle_count * 3u;
  side *sides = sorted_sides(m);
  uint32_t *parent = calloc(corners, sizeof *parent);
  uint32_t *fan = calloc((size_t)m->point_count + 1, sizeof *fan);
  m->edges = calloc(corners, sizeof *m->edges);
  int good = sides != NULL && parent != NULL && fan != NULL && m->edges != NULL;
  if (!good) obj_refuse(error, file, 0, 0, "not enough memory for its edges");
  good = good && add_edges(file, m, sides, error) && check_fans(file, m, parent, fan, error);
  free(sides);
  free(parent);
  free(fan);
  return good;
}

uint32_t obj_edge_between(const obj_mesh *m, uint32_t a, uint32_t b) {
  const uint32_t wanted[2] = {a < b ? a : b, a < b ? b : a};
  uint32_t low = 0;
  uint32_t high = m->edge_count;
  while (low < high) {
    const uint32_t middle = low + (high - low) / 2;
    const uint32_t *p = m->edges[middle].point;
    const uint32_t found[2] = {p[0] < p[1] ? p[0] : p[1], p[0] < p[1] ? p[1] : p[0]};
    const int order = compare_words(found, wanted, 2);
    if (order == 0) return middle;
    if (order < 0)
      low = middle + 1;
    else
      high = middle;
  }
  return OBJ_NONE;
}
