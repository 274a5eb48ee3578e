/* SPDX-License-Identifier: Apache-2.0 */
/* A strip of cloth and its mirror image, held along the line between them: a cantilever with an exact clamp on any
 * mesh. The mesh and all that is worked out from it are those of the strip's scene. */
#ifndef FRAY_TESTS_LIB_DOUBLE_STRIP_H
#define FRAY_TESTS_LIB_DOUBLE_STRIP_H

#include "platform/linux/cpu.h"
#include "rt/membrane/membrane.h"
#include "tests/lib/world_fixture.h"

typedef struct {
  const char *pattern;  /* as a scene says it */
  const char *material; /* lines of its block */
  int warp;             /* 1: the strip goes along the warp */
  int columns, rows;
  double cell_cm;
} double_strip;

FIXTURE void double_strip_scene(fixture *f, const double_strip *s, const char *pattern, int columns, const char *more) {
  fixture_print(f,
                "scene strip\nrate 1000 Hz\nmembrane {\n columns %d\n rows %d\n cell %.4f cm\n pattern %s\n"
                " material own\n weft %d deg\n orientation horizontal\n drag 15 /s\n elastic_steps_max 400\n}\n%s"
                "material own {\n density 200 g/m2\n isotropic 800 N/m 0.3\n%s\n}\nlimits { contacts 0 }\n",
                columns, s->rows, s->cell_cm, pattern, s->warp ? 90 : 0, more, s->material);
}

/* Every pair of triangles that share a side. */
FIXTURE void double_strip_join(trimesh *m) {
  const uint32_t count = (uint32_t)m->state->triangles;
  for (uint32_t t = 0; t < count; ++t)
    for (uint32_t k = 0; k < 3; ++k) m->triangle[t].neighbour[k] = (index_t)t;
  for (uint32_t n = 0; n < 9 * count * count; ++n) {
    const uint32_t a = n / 9 / count, b = n / 9 % count, k = n % 3, j = n / 3 % 3;
    if (m->triangle[a].v[trimesh_next(k)] == m->triangle[b].v[trimesh_previous(j)] &&
        m->triangle[a].v[trimesh_previous(k)] == m->triangle[b].v[trimesh_next(j)])
      m->triangle[a].neighbour[k] = (index_t)b;
  }
  for (uint32_t t = 0; t < count; ++t)
    for (uint32_t k = 0; k < 3; ++k) m->first_triangle[m->triangle[t].v[k]] = (index_t)t;
  for (uint32_t t = 0; t < count; ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (m->triangle[t].neighbour[trimesh_previous(k)] == t) m->first_triangle[m->triangle[t].v[k]] = (index_t)t;
}

/* Along the strip, Q24. */
FIXTURE int32_t *double_strip_along(const fray_world *w, const double_strip *s) {
  return s->warp ? w->trimesh.v : w->trimesh.u;
}

FIXTURE void double_strip_open(fixture *f, const double_strip *s) {
  char pin[32];
  fixture_scoped g = {0};
  snprintf(pin, sizeof pin, "pin column %d\n", s->columns);
  double_strip_scene(f, s, "regular", 2 * s->columns, pin);
  double_strip_scene(&g, s, s->pattern, s->columns, "");
  fray_world *w = f->w;
  const fray_world *from = g.w;
  trimesh *m = &w->trimesh;
  const uint32_t vertices = from->p.count;
  const uint32_t triangles = (uint32_t)from->trimesh.state->triangles;
  const uint32_t attached = (uint32_t)w->params->attached;
  const int32_t *along = double_strip_along(from, s);
  uint32_t to[2][4096];
  uint32_t held = 0;
  w->p.count = attached;
  for (uint32_t p = 0; p < vertices; ++p)
    for (uint32_t half = 0; half < 2; ++half) {
      const int at_clamp = abs(along[p]) < 64;
      uint32_t at = w->p.count;
      if (at_clamp) {
        for (at = 0; at < attached && abs(w->p.z[at] - from->p.z[p]) > 64; ++at) continue;
        held += half;
      } else {
        ++w->p.count;
      }
      to[half][p] = at;
      if (at >= w->capacity[POOL_PARTICLES]) fixture_give_up("double strip", "no room for its vertices");
      const int sign = half == 0 ? 1 : -1;
      m->u[at] = s->warp ? from->trimesh.u[p] : sign * from->trimesh.u[p];
      m->v[at] = s->warp ? sign * from->trimesh.v[p] : from->trimesh.v[p];
      w->p.y[at] = 0;
      w->p.z[at] = from->p.z[p];
      w->p.x[at] = (s->warp ? -sign : sign) * along[p];
      w->p.vx[at] = w->p.vy[at] = w->p.vz[at] = 0;
      w->p.rx[at] = w->p.ry[at] = w->p.rz[at] = 0;
    }
  if (held != attached || 2 * triangles > w->capacity[POOL_TRIANGLES]) fixture_give_up("double strip", "no clamp");
  m->state->triangles = (int32_t)(2 * triangles);
  memset(w->membrane.bend_states, 0, 2 * triangles * sizeof *w->membrane.bend_states);
  memset(w->membrane.stiffness, 0, 2 * triangles * sizeof *w->membrane.stiffness);
  for (uint32_t t = 0; t < 2 * triangles; ++t) {
    const index_t *v = from->trimesh.triangle[t % triangles].v;
    const uint32_t half = t / triangles;
    for (uint32_t k = 0; k < 3; ++k) m->triangle[t].v[k] = (index_t)to[half][v[half == 0 ? k : 2 - k]];
    m->area[t] = from->trimesh.area[t % triangles];
    m->edge_marks[t] = m->material[t] = 0;
  }
  double_strip_join(m);
  *(membrane_params *)(uintptr_t)w->membrane.constants = *from->membrane.constants;
  *(trimesh_params *)(uintptr_t)m->params = *from->trimesh.params;
  memcpy((void *)(uintptr_t)w->membrane.materials, from->membrane.materials, MAX_MATERIALS * sizeof(material_table));
  trimesh_derive(w);
  /* the mesh as built is the double one */
  ((membrane_params *)(uintptr_t)w->membrane.constants)->bend_row_max = (int32_t)bend_folds_find(w);
  (void)cpu_use_best(w);
}

#endif
