/* SPDX-License-Identifier: Apache-2.0 */
/* The tick of rt/run/step.c in double precision: the same rows in the same order, the same stages
 * (drag, bend and shear, gravity, projections with the same polynomial), for sheets whose held
 * particles stand still and that touch nothing. What differs from a world is rounding alone:
 * 1/|d| and all products are exact to 2^-53, nothing is cut to Q24, Q28 or Q20. */
#ifndef FRAY_TESTS_DOUBLE_SHEET_H
#define FRAY_TESTS_DOUBLE_SHEET_H

#include "tests/lib/world_fixture.h"

typedef struct {
  const fray_world *w; /* its constants, rows and rests; its state is not looked at again */
  uint32_t held, particles;
  double (*x)[3]; /* lu */
  double (*v)[3]; /* lu per substep */
  double (*q)[3];
  double gravity[3];
} double_sheet;

FIXTURE void double_sheet_open(double_sheet *s, const fray_world *w) {
  const params *p = w->params;
  s->w = w;
  s->held = (uint32_t)p->held;
  s->particles = (uint32_t)p->particles;
  s->x = calloc(s->particles, sizeof *s->x);
  s->v = calloc(s->particles, sizeof *s->v);
  s->q = calloc(s->particles, sizeof *s->q);
  if (s->x == NULL || s->v == NULL || s->q == NULL) fixture_give_up("double sheet", "memory");
  const int32_t *const x[3] = {w->x, w->y, w->z};
  const int32_t *const v[3] = {w->vx, w->vy, w->vz};
  const int8_t *const r[3] = {w->rx, w->ry, w->rz};
  for (uint32_t n = 0; n < s->particles; ++n)
    for (uint32_t a = 0; a < 3; ++a) {
      s->x[n][a] = x[a][n] * 0x1p-24 + r[a][n] * 0x1p-28;
      s->v[n][a] = v[a][n] * 0x1p-28;
    }
  s->gravity[0] = p->gravity_x * 0x1p-28 + (uint32_t)p->gravity_rest_x * 0x1p-60;
  s->gravity[1] = p->gravity_y * 0x1p-28 + (uint32_t)p->gravity_rest_y * 0x1p-60;
  s->gravity[2] = p->gravity_z * 0x1p-28 + (uint32_t)p->gravity_rest_z * 0x1p-60;
}

FIXTURE void double_sheet_close(double_sheet *s) {
  free(s->x);
  free(s->v);
  free(s->q);
}

FIXTURE void double_sheet_springs(double_sheet *s) {
  const fray_world *w = s->w;
  for (uint32_t row = (uint32_t)w->params->links; row < w->capacity[POOL_ROWS]; ++row) {
    const uint32_t i = w->row_i[row];
    const uint32_t j = w->row_j[row];
    const spring_class *c = &w->springs[w->row_class[row]];
    if (w->row_class[row] == ROW_DEAD || !fixture_row_moves(w, row)) continue;
    const double rest = c->rest * 0x1p-24;
    double d[3];
    double n = 0;
    for (uint32_t a = 0; a < 3; ++a) {
      d[a] = s->x[j][a] - s->x[i][a];
      n += d[a] * d[a];
    }
    if (n == 0 || (c->compression_only != 0 && n >= rest * rest)) continue;
    const double share = (1 - fmin(rest / sqrt(n), 8)) * ldexp(c->mantissa, -c->shift);
    for (uint32_t a = 0; a < 3; ++a) {
      s->v[j][a] -= d[a] * share;
      if (i >= s->held) s->v[i][a] += d[a] * share;
    }
  }
}

/* stage/strain.c: f = u psi(u), of both ends; a compressed link gets its share of it. */
FIXTURE double double_sheet_factor(double n, const link_class *c) {
  const double rest = c->rest * 0x1p-24;
  const double u = fmax(fmin(n / (rest * rest) - 1, 9.0 / 16), -7.0 / 16);
  const double psi = (16384 + u * (-12648 + u * 9961)) / 65536;
  return u * psi * (u < 0 ? c->push / 4096.0 : 1);
}

FIXTURE void double_sheet_project(double_sheet *s) {
  const fray_world *w = s->w;
  for (uint32_t row = 0; row < (uint32_t)w->params->links; ++row) {
    const uint32_t i = w->row_i[row];
    const uint32_t j = w->row_j[row];
    if (w->row_class[row] == ROW_DEAD || j < s->held) continue;
    double d[3];
    double n = 0;
    for (uint32_t a = 0; a < 3; ++a) {
      d[a] = s->x[j][a] - s->x[i][a];
      n += d[a] * d[a];
    }
    const double f = double_sheet_factor(n, &w->links[w->row_class[row]]);
    for (uint32_t a = 0; a < 3; ++a) {
      if (i >= s->held) s->x[i][a] += f * d[a];
      s->x[j][a] -= (i >= s->held ? 1 : 2) * f * d[a];
    }
  }
}

FIXTURE void double_sheet_tick(double_sheet *s) {
  const params *p = s->w->params;
  const double kept = 1 - p->drag * 0x1p-24;
  for (uint32_t n = s->held; n < s->particles; ++n)
    for (uint32_t a = 0; a < 3; ++a) s->v[n][a] *= kept;
  double_sheet_springs(s);
  for (int32_t substep = 0; substep < p->substeps; ++substep) {
    for (uint32_t n = s->held; n < s->particles; ++n)
      for (uint32_t a = 0; a < 3; ++a) {
        s->v[n][a] += s->gravity[a];
        s->q[n][a] = s->x[n][a] += s->v[n][a];
      }
    for (int32_t sweep = 0; sweep < p->sweeps; ++sweep) double_sheet_project(s);
    for (uint32_t n = s->held; n < s->particles; ++n)
      for (uint32_t a = 0; a < 3; ++a) s->v[n][a] += s->x[n][a] - s->q[n][a];
  }
}

/* Root of the mean squared distance over free particles, in lu. */
FIXTURE double double_sheet_distance(const double_sheet *a, const double_sheet *b) {
  double sum = 0;
  for (uint32_t n = a->held; n < a->particles; ++n)
    for (uint32_t k = 0; k < 3; ++k) sum += (a->x[n][k] - b->x[n][k]) * (a->x[n][k] - b->x[n][k]);
  return sqrt(sum / (a->particles - a->held));
}
FIXTURE double double_sheet_error(const double_sheet *s, const fray_world *w) {
  double_sheet other;
  double_sheet_open(&other, w);
  const double distance = double_sheet_distance(s, &other);
  double_sheet_close(&other);
  return distance;
}

#endif
