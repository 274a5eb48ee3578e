/* SPDX-License-Identifier: Apache-2.0 */
/* A world that is only a triangle sheet, without an image: for tests of what tears and cuts do to it.
 * All its arrays stand in one block, so that two worlds can be compared byte by byte. */
#ifndef FRAY_TESTS_BARE_SHEET_H
#define FRAY_TESTS_BARE_SHEET_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rt/model/sheet_split.h"

#define BARE static inline __attribute__((unused))

typedef enum { BARE_REGULAR, BARE_TURNED, BARE_IRREGULAR, BARE_MESHES } bare_mesh;

typedef struct {
  fray_world w;
  params constants;
  sheet_params sheet_constants;
  uint8_t *block; /* state and what follows from it */
  size_t bytes;
  uint32_t particles, triangles; /* that it has memory for: more than its pools say */
} bare_sheet;

/* splitmix64 */
BARE uint64_t bare_random(uint64_t *seed) {
  uint64_t z = (*seed += 0x9E3779B97F4A7C15u);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}
BARE uint32_t bare_below(uint64_t *seed, uint32_t n) {
  return (uint32_t)((bare_random(seed) >> 32) * n >> 32);
}
BARE int32_t bare_between(uint64_t *seed, int32_t least, int32_t most) {
  const uint32_t span = (uint32_t)((int64_t)most - least) + 1u;
  return (int32_t)(least + (int64_t)bare_below(seed, span));
}

BARE void *bare_take(bare_sheet *b, size_t *used, size_t count, size_t bytes) {
  void *at = b->block == NULL ? NULL : b->block + *used;
  *used += (count * bytes + 15u) & ~(size_t)15u;
  return at;
}

enum { BARE_HIDDEN = 16 };

BARE size_t bare_carve(bare_sheet *b) {
  const uint32_t particles = b->particles;
  const uint32_t triangles = b->triangles;
  size_t used = 0;
  fray_world *w = &b->w;
  int32_t **const words[] = {&w->x,  &w->y,  &w->z,  &w->vx,      &w->vy,     &w->vz,
                             &w->qx, &w->qy, &w->qz, &w->sheet.u, &w->sheet.v};
  int8_t **const rests[] = {&w->rx, &w->ry, &w->rz};
  w->state = bare_take(b, &used, 1, sizeof(state));
  w->sheet.state = bare_take(b, &used, 1, sizeof(sheet_state));
  for (size_t n = 0; n < sizeof words / sizeof words[0]; ++n)
    *words[n] = bare_take(b, &used, particles, 4);
  for (size_t n = 0; n < 3; ++n) *rests[n] = bare_take(b, &used, particles, 1);
  w->sheet.fan = bare_take(b, &used, particles, sizeof(row_id));
  w->sheet.mass = bare_take(b, &used, particles, 4);
  w->sheet.triangle = bare_take(b, &used, triangles, sizeof(sheet_triangle));
  w->sheet.area = bare_take(b, &used, triangles, 4);
  w->sheet.mark = bare_take(b, &used, triangles, 1);
  w->sheet.cloth = bare_take(b, &used, triangles, 1);
  w->sheet.weights = bare_take(b, &used, triangles, sizeof(sheet_weights));
  w->habits = bare_take(b, &used, triangles, sizeof(habit));
  w->stress = bare_take(b, &used, triangles, sizeof(tensor));
  w->pull = bare_take(b, &used, triangles, sizeof(pull_row));
  w->sums = bare_take(b, &used, particles, sizeof(inner_sum));
  return used;
}

/* Triangles that share a side, by their corners. */
BARE void bare_join(sheet_mesh *s) {
  const uint32_t count = (uint32_t)s->state->triangles;
  for (uint32_t t = 0; t < count; ++t)
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t from = s->triangle[t].v[sheet_next(k)];
      const uint32_t to = s->triangle[t].v[sheet_last(k)];
      s->triangle[t].across[k] = (row_id)t;
      for (uint32_t o = 0; o < count; ++o)
        for (uint32_t j = 0; j < 3; ++j)
          if (s->triangle[o].v[sheet_next(j)] == to && s->triangle[o].v[sheet_last(j)] == from)
            s->triangle[t].across[k] = (row_id)o;
    }
}

/* The first triangle of every fan: the one with a border on its clockwise side, or any. */
BARE void bare_fans(sheet_mesh *s) {
  const uint32_t count = (uint32_t)s->state->triangles;
  for (uint32_t t = 0; t < count; ++t)
    for (uint32_t k = 0; k < 3; ++k) s->fan[s->triangle[t].v[k]] = (row_id)t;
  for (uint32_t t = 0; t < count; ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (s->triangle[t].across[sheet_last(k)] == t) s->fan[s->triangle[t].v[k]] = (row_id)t;
}

BARE void bare_place(bare_sheet *b, uint32_t p, double u, double v, uint64_t *seed) {
  fray_world *w = &b->w;
  w->sheet.u[p] = (int32_t)lrint(u * FX_LU);
  w->sheet.v[p] = (int32_t)lrint(v * FX_LU);
  int32_t *const at[3] = {w->x, w->y, w->z};
  int32_t *const q[3] = {w->qx, w->qy, w->qz};
  int32_t *const speed[3] = {w->vx, w->vy, w->vz};
  int8_t *const rest[3] = {w->rx, w->ry, w->rz};
  for (uint32_t n = 0; n < 3; ++n) {
    at[n][p] = (n == 0 ? w->sheet.u[p] : n == 1 ? w->sheet.v[p] : 0) +
               bare_between(seed, -200000, 200000);
    q[n][p] = at[n][p] + bare_between(seed, -1000, 1000);
    speed[n][p] = bare_between(seed, -(1 << 30), 1 << 30);
    rest[n][p] = (int8_t)bare_between(seed, -8, 8);
  }
}

/* Tears and cuts may leave half of the least area and a third of the least height. */
BARE void bare_floors(bare_sheet *b) {
  const sheet_mesh *s = &b->w.sheet;
  double area = 1, height = 1;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    const row_id *v = s->triangle[t].v;
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

BARE void bare_lower_floors(bare_sheet *b) {
  b->sheet_constants.area_min /= 5;
  b->sheet_constants.height_min /= 2;
}

/* columns x rows squares of 1/10 lu, two triangles each; the first row of vertices is held. The pools
 * have room for so many more. */
BARE void bare_open(bare_sheet *b, bare_mesh mesh, uint32_t columns, uint32_t rows,
                    uint32_t spare_particles, uint32_t spare_triangles, uint64_t seed) {
  const uint32_t particles = (columns + 1) * (rows + 1);
  const uint32_t triangles = 2 * columns * rows;
  const double turn = mesh == BARE_TURNED ? 0.5235987755982988 : 0;
  memset(b, 0, sizeof *b);
  b->particles = particles + spare_particles + BARE_HIDDEN;
  b->triangles = triangles + spare_triangles + BARE_HIDDEN;
  b->bytes = bare_carve(b);
  b->block = calloc(1, b->bytes);
  if (b->block == NULL) exit(1);
  (void)bare_carve(b);
  fray_world *w = &b->w;
  w->params = &b->constants;
  w->sheet.params = &b->sheet_constants;
  w->capacity[POOL_PARTICLES] = particles + spare_particles;
  w->capacity[POOL_TRIANGLES] = triangles + spare_triangles;
  b->constants.particles = (int32_t)particles;
  b->constants.held = (int32_t)columns + 1;
  b->sheet_constants.triangles = w->sheet.state->triangles = (int32_t)triangles;
  b->sheet_constants.cloths = 1;
  w->particles = particles;
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
      sheet_triangle *f = &w->sheet.triangle[2 * n + half];
      f->v[0] = (row_id)corner[from];
      f->v[1] = (row_id)corner[from + 1 + half];
      f->v[2] = (row_id)corner[(from + 2 + half) % 4];
    }
  }
  bare_join(&w->sheet);
  bare_fans(&w->sheet);
  for (uint32_t t = 0; t < triangles; ++t) {
    const row_id *v = w->sheet.triangle[t].v;
    w->sheet.area[t] = (uint32_t)fx_round64(
        sheet_twice_area(sheet_at(&w->sheet, v[0]), sheet_at(&w->sheet, v[1]),
                         sheet_at(&w->sheet, v[2])), 19);
  }
  bare_floors(b);
  sheet_derive(w);
  const uint64_t topology = sheet_topology(w);
  w->state->topology[0] = (int32_t)(uint32_t)(topology & 0xFFFFFFFFu);
  w->state->topology[1] = (int32_t)(uint32_t)(topology >> 32);
}

/* The same world once more. */
BARE void bare_copy(bare_sheet *to, const bare_sheet *from) {
  *to = *from;
  to->block = malloc(from->bytes);
  if (to->block == NULL) exit(1);
  memcpy(to->block, from->block, from->bytes);
  (void)bare_carve(to);
  to->w.params = &to->constants;
  to->w.sheet.params = &to->sheet_constants;
}

BARE int bare_is_same(const bare_sheet *a, const bare_sheet *b) {
  return a->w.particles == b->w.particles && memcmp(a->block, b->block, a->bytes) == 0;
}

BARE void bare_close(bare_sheet *b) { free(b->block); }

#endif
