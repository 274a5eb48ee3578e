/* SPDX-License-Identifier: Apache-2.0 */
/* A world that is only a membrane, without an image: for tests of what tears and cuts do to it.
 * All its arrays stand in one block, so that two worlds can be compared byte by byte. */
#ifndef FRAY_TESTS_LIB_BARE_MEMBRANE_H
#define FRAY_TESTS_LIB_BARE_MEMBRANE_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rt/trimesh/trimesh_split.h"
#include "tests/lib/splitmix64.h"

#define BARE static inline __attribute__((unused))

typedef enum { BARE_REGULAR, BARE_TURNED, BARE_IRREGULAR, BARE_MESHES } bare_mesh;

typedef struct {
  fray_world w;
  params constants;
  trimesh_params sheet_constants;
  uint8_t *block; /* state and what follows from it */
  size_t bytes;
  uint32_t particles, triangles; /* that it has memory for: more than its pools say */
} bare_membrane;

BARE uint32_t bare_below(uint64_t *seed, uint32_t n) {
  return (uint32_t)((splitmix64(seed) >> 32) * n >> 32);
}
BARE int32_t bare_between(uint64_t *seed, int32_t least, int32_t most) {
  const uint32_t span = (uint32_t)((int64_t)most - least) + 1u;
  return (int32_t)(least + (int64_t)bare_below(seed, span));
}

BARE void *bare_allocate(bare_membrane *b, size_t *used, size_t count, size_t bytes) {
  void *at = b->block == NULL ? NULL : b->block + *used;
  *used += (count * bytes + 15u) & ~(size_t)15u;
  return at;
}

enum { BARE_HIDDEN = 16 };

BARE size_t bare_layout(bare_membrane *b) {
  const uint32_t particles = b->particles;
  const uint32_t triangles = b->triangles;
  size_t used = 0;
  fray_world *w = &b->w;
  int32_t **const words[] = {&w->p.x,  &w->p.y,  &w->p.z,  &w->p.vx,      &w->p.vy,     &w->p.vz,
                             &w->p.qx, &w->p.qy, &w->p.qz, &w->trimesh.u, &w->trimesh.v};
  int8_t **const rests[] = {&w->p.rx, &w->p.ry, &w->p.rz};
  w->state = bare_allocate(b, &used, 1, sizeof(state));
  w->trimesh.state = bare_allocate(b, &used, 1, sizeof(trimesh_state));
  for (size_t n = 0; n < sizeof words / sizeof words[0]; ++n)
    *words[n] = bare_allocate(b, &used, particles, 4);
  for (size_t n = 0; n < 3; ++n) *rests[n] = bare_allocate(b, &used, particles, 1);
  w->trimesh.first_triangle = bare_allocate(b, &used, particles, sizeof(index_t));
  w->trimesh.mass = bare_allocate(b, &used, particles, 4);
  w->trimesh.triangle = bare_allocate(b, &used, triangles, sizeof(trimesh_triangle));
  w->trimesh.area = bare_allocate(b, &used, triangles, 4);
  w->trimesh.edge_marks = bare_allocate(b, &used, triangles, 1);
  w->trimesh.material = bare_allocate(b, &used, triangles, 1);
  w->trimesh.weights = bare_allocate(b, &used, triangles, sizeof(trimesh_weights));
  w->membrane.stiffness = bare_allocate(b, &used, triangles, sizeof(stiffness_state));
  w->membrane.bend_states = bare_allocate(b, &used, triangles, sizeof(bend_state));
  w->membrane.bend_shapes = bare_allocate(b, &used, triangles, sizeof(bend_shape));
  w->membrane.stress = bare_allocate(b, &used, triangles, sizeof(material_tensor));
  w->membrane.gains = bare_allocate(b, &used, triangles, sizeof(membrane_gain));
  w->membrane.impulse = bare_allocate(b, &used, particles, sizeof(elastic_impulse));
  return used;
}

/* Triangles that share a side, by their corners. */
BARE void bare_join(trimesh *s) {
  const uint32_t count = (uint32_t)s->state->triangles;
  for (uint32_t t = 0; t < count; ++t)
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t from = s->triangle[t].v[trimesh_next(k)];
      const uint32_t to = s->triangle[t].v[trimesh_previous(k)];
      s->triangle[t].neighbour[k] = (index_t)t;
      for (uint32_t o = 0; o < count; ++o)
        for (uint32_t j = 0; j < 3; ++j)
          if (s->triangle[o].v[trimesh_next(j)] == to && s->triangle[o].v[trimesh_previous(j)] == from)
            s->triangle[t].neighbour[k] = (index_t)o;
    }
}

/* The first triangle of every fan: the one with a border on its clockwise side, or any. */
BARE void bare_one_rings(trimesh *s) {
  const uint32_t count = (uint32_t)s->state->triangles;
  for (uint32_t t = 0; t < count; ++t)
    for (uint32_t k = 0; k < 3; ++k) s->first_triangle[s->triangle[t].v[k]] = (index_t)t;
  for (uint32_t t = 0; t < count; ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (s->triangle[t].neighbour[trimesh_previous(k)] == t) s->first_triangle[s->triangle[t].v[k]] = (index_t)t;
}

BARE void bare_place(bare_membrane *b, uint32_t p, double u, double v, uint64_t *seed) {
  fray_world *w = &b->w;
  w->trimesh.u[p] = (int32_t)lrint(u * FX_LU);
  w->trimesh.v[p] = (int32_t)lrint(v * FX_LU);
  int32_t *const at[3] = {w->p.x, w->p.y, w->p.z};
  int32_t *const q[3] = {w->p.qx, w->p.qy, w->p.qz};
  int32_t *const speed[3] = {w->p.vx, w->p.vy, w->p.vz};
  int8_t *const rest[3] = {w->p.rx, w->p.ry, w->p.rz};
  for (uint32_t n = 0; n < 3; ++n) {
    at[n][p] = (n == 0 ? w->trimesh.u[p] : n == 1 ? w->trimesh.v[p] : 0) +
               bare_between(seed, -200000, 200000);
    q[n][p] = at[n][p] + bare_between(seed, -1000, 1000);
    speed[n][p] = bare_between(seed, -(1 << 30), 1 << 30);
    rest[n][p] = (int8_t)bare_between(seed, -8, 8);
  }
}

/* Tears and cuts may leave half of the least area and a third of the least height. */
BARE void bare_min_quality(bare_membrane *b) {
  const trimesh *s = &b->w.trimesh;
  double area = 1, height = 1;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    const index_t *v = s->triangle[t].v;
    double longest = 0;
    for (uint32_t k = 0; k < 3; ++k)
      longest = fmax(longest, hypot((double)s->u[v[k]] - s->u[v[(k + 1) % 3]],
                                    (double)s->v[v[k]] - s->v[v[(k + 1) % 3]]) / FX_LU);
    area = fmin(area, s->area[t] / 1073741824.0);
    height = fmin(height, 2 * s->area[t] / 1073741824.0 / longest);
  }
  b->sheet_constants.area_min = (int32_t)(area / 2 * 1073741824.0);
  b->sheet_constants.height_min = (int32_t)(height / 3 * FX_LU);
}

BARE void bare_lower_min_quality(bare_membrane *b) {
  b->sheet_constants.area_min /= 5;
  b->sheet_constants.height_min /= 2;
}

/* columns x rows squares of 1/10 lu, two triangles each; the first row of vertices is held. The pools
 * have room for so many more. */
BARE void bare_open(bare_membrane *b, bare_mesh mesh, uint32_t columns, uint32_t rows,
                    uint32_t spare_particles, uint32_t spare_triangles, uint64_t seed) {
  const uint32_t particles = (columns + 1) * (rows + 1);
  const uint32_t triangles = 2 * columns * rows;
  const double turn = mesh == BARE_TURNED ? 0.5235987755982988 : 0;
  memset(b, 0, sizeof *b);
  b->particles = particles + spare_particles + BARE_HIDDEN;
  b->triangles = triangles + spare_triangles + BARE_HIDDEN;
  b->bytes = bare_layout(b);
  b->block = calloc(1, b->bytes);
  if (b->block == NULL) exit(1);
  (void)bare_layout(b);
  fray_world *w = &b->w;
  w->params = &b->constants;
  w->trimesh.params = &b->sheet_constants;
  w->capacity[POOL_PARTICLES] = particles + spare_particles;
  w->capacity[POOL_TRIANGLES] = triangles + spare_triangles;
  world_find_features(w);
  b->constants.particles = (int32_t)particles;
  b->constants.attached = (int32_t)columns + 1;
  b->sheet_constants.triangles = w->trimesh.state->triangles = (int32_t)triangles;
  b->sheet_constants.materials = 1;
  w->p.count = particles;
  for (uint32_t j = 0; j <= rows; ++j)
    for (uint32_t i = 0; i <= columns; ++i) {
      const int inside = i > 0 && i < columns && j > 0 && j < rows;
      const double most = mesh == BARE_IRREGULAR && inside ? 0.25 : 0;
      const double x = 0.1 * (i + most * bare_between(&seed, -1000, 1000) / 1000.0);
      const double y = 0.1 * (j + most * bare_between(&seed, -1000, 1000) / 1000.0);
      bare_place(b, j * (columns + 1) + i, x * cos(turn) - y * sin(turn),
                 x * sin(turn) + y * cos(turn), &seed);
    }
  for (uint32_t n = 0; n < columns * rows; ++n) {
    const uint32_t p = n / columns * (columns + 1) + n % columns;
    const uint32_t corner[4] = {p, p + 1, p + columns + 2, p + columns + 1};
    const uint32_t from = mesh == BARE_IRREGULAR ? bare_below(&seed, 2) : 0;
    for (uint32_t half = 0; half < 2; ++half) {
      trimesh_triangle *f = &w->trimesh.triangle[2 * n + half];
      f->v[0] = (index_t)corner[from];
      f->v[1] = (index_t)corner[from + 1 + half];
      f->v[2] = (index_t)corner[(from + 2 + half) % 4];
    }
  }
  bare_join(&w->trimesh);
  bare_one_rings(&w->trimesh);
  for (uint32_t t = 0; t < triangles; ++t) {
    const index_t *v = w->trimesh.triangle[t].v;
    w->trimesh.area[t] = (uint32_t)fx_round64(
        trimesh_twice_area(trimesh_at(&w->trimesh, v[0]), trimesh_at(&w->trimesh, v[1]),
                         trimesh_at(&w->trimesh, v[2])), 19);
  }
  bare_min_quality(b);
  trimesh_derive(w);
  const uint64_t topology = trimesh_topology(w);
  w->state->topology[0] = (int32_t)(uint32_t)(topology & 0xFFFFFFFFu);
  w->state->topology[1] = (int32_t)(uint32_t)(topology >> 32);
}

/* The same world once more. */
BARE void bare_copy(bare_membrane *to, const bare_membrane *from) {
  *to = *from;
  to->block = malloc(from->bytes);
  if (to->block == NULL) exit(1);
  memcpy(to->block, from->block, from->bytes);
  (void)bare_layout(to);
  to->w.params = &to->constants;
  to->w.trimesh.params = &to->sheet_constants;
}

BARE int bare_is_same(const bare_membrane *a, const bare_membrane *b) {
  return a->w.p.count == b->w.p.count && memcmp(a->block, b->block, a->bytes) == 0;
}

BARE void bare_close(bare_membrane *b) {
  free(b->block);
  b->block = NULL;
}

#endif
