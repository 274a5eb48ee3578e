/* SPDX-License-Identifier: Apache-2.0 */
/* Slits of membranes: edges along grid lines that are open at tick 0. */
#include "rt/trimesh/trimesh_split.h"
#include "tools/scene_compiler/membrane.h"

/* The copies of a split vertex have the same place at rest. */
static int is_at(const trimesh *s, uint32_t p, uint32_t of) {
  return s->u[p] == s->u[of] && s->v[p] == s->v[of];
}

static trimesh_result open_between(fray_world *w, uint32_t a, uint32_t b) {
  const trimesh *s = &w->trimesh;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (trimesh_neighbour(s, t, k) != TRIMESH_NONE && is_at(s, s->triangle[t].v[trimesh_next(k)], a) &&
          is_at(s, s->triangle[t].v[trimesh_previous(k)], b))
        return trimesh_open_edge(w, t, k, TRIMESH_CUT);
  return TRIMESH_NO_PATH;
}

int draft_membrane_slits(const draft *d, fray_world *w) {
  const uint32_t columns = d->scene->membrane.columns;
  for (uint32_t n = 0; n < d->scene->slit_count; ++n) {
    const scene_slit *slit = &d->scene->slits[n];
    for (uint32_t at = slit->first; at < slit->last; ++at) {
      const uint32_t along = slit->beside_weft ? 1 : columns + 1;
      const uint32_t first =
          slit->beside_weft ? slit->yarn * (columns + 1) + at : at * (columns + 1) + slit->yarn;
      const trimesh_result result = open_between(w, d->particle[first], d->particle[first + along]);
      if (result == TRIMESH_NO_PARTICLES)
        return draft_refuse(d, slit->place,
                            "found too few spare_particles in limits, expected one for each vertex of "
                            "a slit");
      if (result != TRIMESH_DONE)
        return draft_refuse(d, slit->place,
                            "found a slit that splits an attached vertex, or an edge twice, expected "
                            "neither");
    }
  }
  return 1;
}
