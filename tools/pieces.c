/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/pieces.h"

#include <stdlib.h>

static uint32_t root_of(uint32_t *parent, uint32_t n) {
  while (parent[n] != n) n = parent[n] = parent[parent[n]];
  return n;
}

static int larger(const void *left, const void *right) {
  const piece *a = left;
  const piece *b = right;
  if (a->crossings != b->crossings) return a->crossings < b->crossings ? 1 : -1;
  return (a->holders > b->holders) - (a->holders < b->holders);
}

static void join_rows(const fray_world *w, uint32_t *parent) {
  const uint32_t rows = fray_describe(w).rows[FRAY_STRUCTURAL];
  for (uint32_t row = 0; row < rows; ++row) {
    const fray_row r = fray_view_row(w, FRAY_STRUCTURAL, row);
    if (r.alive) parent[root_of(parent, r.i)] = root_of(parent, r.j);
  }
}

static void join_couples(const fray_world *w, uint32_t *parent) {
  const fray_sheet sheet = fray_view_sheet(w);
  for (uint32_t c = 0; c < sheet.warps * sheet.wefts; ++c)
    if (fray_couple_at(w, c) != FRAY_DISCONNECTED)
      parent[root_of(parent, fray_particle_of(w, c, FRAY_WEFT))] =
          root_of(parent, fray_particle_of(w, c, FRAY_WARP));
}

static void join_triangles(const fray_world *w, uint32_t *parent) {
  const uint32_t triangles = fray_describe(w).triangles;
  for (uint32_t t = 0; t < triangles; ++t) {
    const fray_triangle f = fray_view_triangle(w, t);
    for (uint32_t k = 1; k < 3; ++k) parent[root_of(parent, f.vertex[0])] = root_of(parent, f.vertex[k]);
  }
}

uint32_t pieces_find(const fray_world *w, piece *out, uint32_t room) {
  const fray_particles p = fray_view_particles(w);
  uint32_t *parent = malloc(p.count * sizeof *parent);
  piece *all = calloc(p.count, sizeof *all);
  uint32_t count = 0;
  if (parent != NULL && all != NULL) {
    for (uint32_t n = 0; n < p.count; ++n) parent[n] = n;
    join_rows(w, parent);
    join_couples(w, parent);
    join_triangles(w, parent);
    for (uint32_t n = 0; n < p.count; ++n) {
      piece *root = &all[root_of(parent, n)];
      ++root->crossings;
      if (n < p.held) root->holders |= 1u << fray_holder(w, n);
    }
    qsort(all, p.count, sizeof *all, larger);
    while (count < p.count && all[count].crossings > 0) ++count;
    for (uint32_t n = 0; n < count && n < room; ++n) out[n] = all[n];
  }
  free(parent);
  free(all);
  return count;
}
