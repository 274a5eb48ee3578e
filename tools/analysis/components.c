/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/analysis/components.h"

#include <stdlib.h>

static uint32_t root_of(uint32_t *parent, uint32_t n) {
  while (parent[n] != n) n = parent[n] = parent[parent[n]];
  return n;
}

static int larger(const void *left, const void *right) {
  const component *a = left;
  const component *b = right;
  if (a->crossings != b->crossings) return a->crossings < b->crossings ? 1 : -1;
  return (a->holders > b->holders) - (a->holders < b->holders);
}

static void join_springs(const fray_world *w, uint32_t *parent) {
  const uint32_t springs = fray_get_info(w).springs[FRAY_STRUCTURAL];
  for (uint32_t n = 0; n < springs; ++n) {
    const fray_spring r = fray_view_spring(w, FRAY_STRUCTURAL, n);
    if (r.alive) parent[root_of(parent, r.i)] = root_of(parent, r.j);
  }
}

static void join_crossings(const fray_world *w, uint32_t *parent) {
  const fray_weave weave = fray_view_weave(w);
  for (uint32_t c = 0; c < weave.warps * weave.wefts; ++c)
    if (fray_crossing_state_at(w, c) != FRAY_DISCONNECTED)
      parent[root_of(parent, fray_yarn_particle(w, c, FRAY_WEFT))] =
          root_of(parent, fray_yarn_particle(w, c, FRAY_WARP));
}

static void join_triangles(const fray_world *w, uint32_t *parent) {
  const uint32_t triangles = fray_get_info(w).triangles;
  for (uint32_t t = 0; t < triangles; ++t) {
    const fray_triangle f = fray_view_triangle(w, t);
    for (uint32_t k = 1; k < 3; ++k) parent[root_of(parent, f.vertex[0])] = root_of(parent, f.vertex[k]);
  }
}

uint32_t components_find(const fray_world *w, component *out, uint32_t room) {
  const fray_particles p = fray_view_particles(w);
  uint32_t *parent = malloc(p.count * sizeof *parent);
  component *all = calloc(p.count, sizeof *all);
  uint32_t count = 0;
  if (parent != NULL && all != NULL) {
    for (uint32_t n = 0; n < p.count; ++n) parent[n] = n;
    join_springs(w, parent);
    join_crossings(w, parent);
    join_triangles(w, parent);
    for (uint32_t n = 0; n < p.count; ++n) {
      component *root = &all[root_of(parent, n)];
      ++root->crossings;
      if (n < p.attached) root->holders |= 1u << fray_attached_body(w, n);
    }
    qsort(all, p.count, sizeof *all, larger);
    while (count < p.count && all[count].crossings > 0) ++count;
    for (uint32_t n = 0; n < count && n < room; ++n) out[n] = all[n];
  }
  free(parent);
  free(all);
  return count;
}
