/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/scene_compiler/planar_mesh.h"

#include <stdlib.h>
#include <string.h>

#include "rt/base/random.h"

void planar_mesh_free(planar_mesh *m) {
  free(m->s);
  free(m->t);
  free(m->column);
  free(m->row);
  free(m->corner);
  memset(m, 0, sizeof *m);
}

static int take(draft *d, planar_mesh *m, uint32_t points, uint32_t triangles) {
  m->s = calloc(points, sizeof *m->s);
  m->t = calloc(points, sizeof *m->t);
  m->column = calloc(points, sizeof *m->column);
  m->row = calloc(points, sizeof *m->row);
  m->corner = calloc(triangles, sizeof *m->corner);
  if (m->s == NULL || m->t == NULL || m->column == NULL || m->row == NULL || m->corner == NULL)
    return draft_no_memory(d);
  return 1;
}

static int refuse_size(const draft *d, uint32_t axis) {
  const char *key = axis == 0 ? "columns" : "rows";
  const exact edge = d->scene->membrane.cell[axis];
  int64_t most = 0;
  (void)exact_mul_div(32, exact_mul(edge, d->lu_per_cm).denominator, exact_mul(edge, d->lu_per_cm).numerator,
                      &most);
  return draft_expected(d, BLOCK_CLOTH, key, "at most %lld cells of this size", (long long)most);
}

/* Place of grid line n, rounded once. */
static int line_at(const draft *d, uint32_t axis, uint32_t n, int32_t *at) {
  int64_t fixed;
  const exact way = exact_mul(d->scene->membrane.cell[axis], exact_make(n, 1));
  if (!exact_to_fixed(exact_mul(way, d->lu_per_cm), FX_POSITION_BITS, &fixed) || fixed > 32 * FX_LU)
    return refuse_size(d, axis);
  *at = (int32_t)fixed;
  return 1;
}

static int add_point(planar_mesh *m, int32_t s, int32_t t, uint32_t column, uint32_t row) {
  const uint32_t p = m->points++;
  m->s[p] = s;
  m->t[p] = t;
  m->column[p] = column;
  m->row[p] = row;
  return 1;
}

static void add_triangle(planar_mesh *m, uint32_t a, uint32_t b, uint32_t c) {
  uint32_t *corner = m->corner[m->triangles++];
  corner[0] = a;
  corner[1] = b;
  corner[2] = c;
}

/* Rows from the top; diagonals of neighbouring cells alternate. */
static int make_regular(draft *d, planar_mesh *m) {
  const uint32_t columns = d->scene->membrane.columns;
  const uint32_t rows = d->scene->membrane.rows;
  int32_t s = 0;
  int32_t t = 0;
  for (uint32_t j = 0; j <= rows; ++j)
    for (uint32_t i = 0; i <= columns; ++i)
      if (!line_at(d, 0, i, &s) || !line_at(d, 1, rows - j, &t) || !add_point(m, s, t, i, j))
        return 0;
  for (uint32_t j = 0; j < rows; ++j)
    for (uint32_t i = 0; i < columns; ++i) {
      const uint32_t a = (j + 1) * (columns + 1) + i; /* below left */
      const uint32_t b = a + 1;
      const uint32_t top = j * (columns + 1) + i;
      const uint32_t c = top + 1;
      if ((i + j) % 2 != 0) {
        add_triangle(m, a, b, c);
        add_triangle(m, a, c, top);
      } else {
        add_triangle(m, a, b, top);
        add_triangle(m, b, c, top);
      }
    }
  return 1;
}

/* The four edges, with the points of the grid. */
static int add_border(draft *d, planar_mesh *m, uint32_t columns, uint32_t rows) {
  int32_t s = 0;
  int32_t t = 0;
  int32_t width = 0;
  int32_t height = 0;
  if (!line_at(d, 0, columns, &width) || !line_at(d, 1, rows, &height)) return 0;
  for (uint32_t i = 0; i <= columns; ++i) {
    if (!line_at(d, 0, i, &s)) return 0;
    add_point(m, s, height, i, 0);
    add_point(m, s, 0, i, rows);
  }
  for (uint32_t j = 1; j < rows; ++j) {
    if (!line_at(d, 1, rows - j, &t)) return 0;
    add_point(m, 0, t, 0, j);
    add_point(m, width, t, columns, j);
  }
  return 1;
}

/* Points of the grid, each moved by up to 0.28 of a cell along both directions. */
static int add_moved(draft *d, planar_mesh *m, uint32_t columns, uint32_t rows) {
  const int32_t far_s = (int32_t)((int64_t)d->spacing[0] * 28 / 100);
  const int32_t far_t = (int32_t)((int64_t)d->spacing[1] * 28 / 100);
  const uint32_t seed = d->scene->membrane.pattern_seed;
  int32_t s = 0;
  int32_t t = 0;
  for (uint32_t j = 1; j < rows; ++j)
    for (uint32_t i = 1; i < columns; ++i) {
      const uint32_t element = 2 * (j * columns + i);
      if (!line_at(d, 0, i, &s) || !line_at(d, 1, rows - j, &t)) return 0;
      add_point(m, s + random_between(seed, element, -far_s, far_s),
                t + random_between(seed, element + 1, -far_t, far_t), PLANAR_MESH_INSIDE, PLANAR_MESH_INSIDE);
    }
  return 1;
}

/* Points of a grid that is rotated about the middle of the rectangle, those at least 0.45 of a cell from its
 * edges. */
static int add_rotated(draft *d, planar_mesh *m, uint32_t columns, uint32_t rows) {
  const exact one = exact_make(1, 1);
  const exact h = d->scene->membrane.pattern_half_tangent;
  const exact whole = exact_add(one, exact_mul(h, h));
  const int32_t width = m->s[2 * columns];
  const int32_t height = m->t[0];
  const int32_t off_s = (int32_t)((int64_t)d->spacing[0] * 45 / 100);
  const int32_t off_t = (int32_t)((int64_t)d->spacing[1] * 45 / 100);
  const int32_t max = (int32_t)(columns > rows ? 2 * columns : 2 * rows);
  int64_t c;
  int64_t sine;
  if (!exact_to_fixed(exact_div(exact_sub(one, exact_mul(h, h)), whole), 30, &c) ||
      !exact_to_fixed(exact_div(exact_add(h, h), whole), 30, &sine))
    return draft_expected(d, BLOCK_CLOTH, "pattern", "an angle of fewer digits");
  for (int32_t j = -max; j <= max; ++j)
    for (int32_t i = -max; i <= max; ++i) {
      const int64_t x = (int64_t)i * d->spacing[0];
      const int64_t y = (int64_t)j * d->spacing[1];
      const int64_t s = width / 2 + fx_round64(fx_asr64(x * c, 15) - fx_asr64(y * sine, 15), 15);
      const int64_t t = height / 2 + fx_round64(fx_asr64(x * sine, 15) + fx_asr64(y * c, 15), 15);
      if (s >= off_s && s <= width - off_s && t >= off_t && t <= height - off_t)
        add_point(m, (int32_t)s, (int32_t)t, PLANAR_MESH_INSIDE, PLANAR_MESH_INSIDE);
    }
  return 1;
}

int planar_mesh_make(draft *d, planar_mesh *m) {
  const scene *s = d->scene;
  const uint32_t columns = s->membrane.columns;
  const uint32_t rows = s->membrane.rows;
  const uint32_t room = s->membrane.pattern == PATTERN_ROTATED ? 2 : 1;
  memset(m, 0, sizeof *m);
  if (!take(d, m, room * (columns + 3) * (rows + 3), room * 2 * (columns + 3) * (rows + 3)))
    return 0;
  if (s->membrane.pattern == PATTERN_REGULAR) return make_regular(d, m);
  if (columns < 2 || rows < 2)
    return draft_expected(d, BLOCK_CLOTH, columns < 2 ? "columns" : "rows",
                          "at least 2 with a pattern that is not "
                          "regular");
  if (!add_border(d, m, columns, rows)) return 0;
  if (!(s->membrane.pattern == PATTERN_ROTATED ? add_rotated(d, m, columns, rows)
                                         : add_moved(d, m, columns, rows)))
    return 0;
  if (!delaunay_triangulate(m))
    return draft_expected(d, BLOCK_CLOTH, "pattern",
                          "cells nearer to squares, or another angle: there is no triangulation of these "
                          "points");
  return 1;
}
