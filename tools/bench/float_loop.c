/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/float_loop.h"

#include <math.h>
#include <stdlib.h>

/* Which of four passes takes a link. */
static uint32_t colour(fray_weave s, uint32_t home) {
  const uint32_t across = s.wefts * (s.warps - 1);
  if (home < across) return home % (s.warps - 1) % 2;
  return 2 + (home - across) / s.warps % 2;
}

/* Row of each canonical link. */
static void sort_rows(const fray_world *w, uint32_t *row_of) {
  const uint32_t rows = fray_get_info(w).springs[FRAY_STRUCTURAL];
  for (uint32_t n = 0; n < rows; ++n)
    row_of[fray_view_spring(w, FRAY_STRUCTURAL, n).id] = n;
}

static void take_row(float_loop *f, const fray_world *w, uint32_t row, uint32_t held) {
  const fray_spring r = fray_view_spring(w, FRAY_STRUCTURAL, row);
  if (!r.alive || (r.i < held && r.j < held)) return;
  f->i[f->rows] = r.i;
  f->j[f->rows] = r.j;
  f->rest[f->rows++] = (float)r.rest * 0x1p-24f;
}

static void take_rows(float_loop *f, const fray_world *w, const uint32_t *row_of,
                      float_order order) {
  const fray_weave s = fray_view_weave(w);
  const uint32_t rows = fray_get_info(w).springs[FRAY_STRUCTURAL];
  const uint32_t held = fray_view_particles(w).attached;
  for (uint32_t pass = 0; pass < (order == FLOAT_COLOURED ? 4u : 1u); ++pass)
    for (uint32_t n = 0; n < rows; ++n) {
      if (order == FLOAT_COLOURED && colour(s, n) != pass) continue;
      take_row(f, w, order == FLOAT_BATCHED ? n : row_of[n], held);
    }
}

int float_loop_open(float_loop *f, const fray_world *w, float_order order) {
  const fray_particles p = fray_view_particles(w);
  const uint32_t rows = fray_get_info(w).springs[FRAY_STRUCTURAL];
  uint32_t *row_of = malloc(rows * sizeof *row_of);
  f->particles = malloc(p.count * sizeof *f->particles);
  f->i = malloc(rows * sizeof *f->i);
  f->j = malloc(rows * sizeof *f->j);
  f->rest = malloc(rows * sizeof *f->rest);
  f->rows = 0;
  const int good = row_of && f->particles && f->i && f->j && f->rest;
  if (good) {
    float_loop_restore(f, w);
    sort_rows(w, row_of);
    take_rows(f, w, row_of, order);
  }
  free(row_of);
  return good;
}

void float_loop_restore(float_loop *f, const fray_world *w) {
  const fray_particles p = fray_view_particles(w);
  for (uint32_t n = 0; n < p.count; ++n)
    f->particles[n] = (float_particle){(float)p.x[n] * 0x1p-24f, (float)p.y[n] * 0x1p-24f,
                                       (float)p.z[n] * 0x1p-24f, n < p.attached ? 0.0f : 1.0f};
}

void float_loop_iterate(float_loop *f) {
  for (uint32_t n = 0; n < f->rows; ++n) {
    float_particle *a = &f->particles[f->i[n]];
    float_particle *b = &f->particles[f->j[n]];
    const float dx = b->x - a->x;
    const float dy = b->y - a->y;
    const float dz = b->z - a->z;
    const float length = sqrtf(dx * dx + dy * dy + dz * dz);
    const float share = (1.0f - f->rest[n] / length) / (a->weight + b->weight);
    const float move_a = share * a->weight;
    const float move_b = share * b->weight;
    a->x += move_a * dx;
    a->y += move_a * dy;
    a->z += move_a * dz;
    b->x -= move_b * dx;
    b->y -= move_b * dy;
    b->z -= move_b * dz;
  }
}

void float_loop_close(float_loop *f) {
  free(f->particles);
  free(f->i);
  free(f->j);
  free(f->rest);
}
