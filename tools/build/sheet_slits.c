/* SPDX-License-Identifier: Apache-2.0 */
/* Sides of a triangle sheet that are open at tick 0, along the lines of its grid. */
#include "rt/model/sheet_split.h"
#include "tools/build/triangles.h"

/* What was one vertex is one place at rest. */
static int is_at(const sheet_mesh *s, uint32_t p, uint32_t of) {
  return s->u[p] == s->u[of] && s->v[p] == s->v[of];
}

static sheet_result open_between(fray_world *w, uint32_t a, uint32_t b) {
  const sheet_mesh *s = &w->sheet;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (sheet_across(s, t, k) != SHEET_NONE && is_at(s, s->triangle[t].v[sheet_next(k)], a) &&
          is_at(s, s->triangle[t].v[sheet_last(k)], b))
        return sheet_open_side(w, t, k, SHEET_CUT);
  return SHEET_NO_WAY;
}

int draft_sheet_slits(const draft *d, fray_world *w) {
  const uint32_t columns = d->scene->triangles.columns;
  for (uint32_t n = 0; n < d->scene->slit_count; ++n) {
    const scene_slit *slit = &d->scene->slits[n];
    for (uint32_t at = slit->first; at < slit->last; ++at) {
      const uint32_t along = slit->beside_weft ? 1 : columns + 1;
      const uint32_t first = slit->beside_weft ? slit->yarn * (columns + 1) + at : at * (columns + 1) + slit->yarn;
      const sheet_result result = open_between(w, d->particle[first], d->particle[first + along]);
      if (result == SHEET_NO_PARTICLES)
        return draft_refuse(d, slit->line, "spare_particles: expected one for each vertex of a slit");
      if (result != SHEET_DONE)
        return draft_refuse(d, slit->line, "slit: expected it not to divide a held vertex, nor to cut twice");
    }
  }
  return 1;
}
