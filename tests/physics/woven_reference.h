/* SPDX-License-Identifier: Apache-2.0 */
/* The tick of rt/tick/tick.c in double precision: the same rows in the same order, the same stages
 * (drag, bend and shear, gravity, projections with the same polynomial), for sheets whose held
 * particles stand still and that touch nothing. What differs from a world is rounding alone:
 * 1/|d| and all products are exact to 2^-53, nothing is cut to Q24, Q28 or Q20. */
#ifndef FRAY_TESTS_PHYSICS_WOVEN_REFERENCE_H
#define FRAY_TESTS_PHYSICS_WOVEN_REFERENCE_H

#include "tests/lib/world_fixture.h"

typedef struct {
  const fray_world *w; /* its constants, rows and rests; its state is not looked at again */
  uint32_t held, particles;
  double (*x)[3]; /* lu */
  double (*v)[3]; /* lu per substep */
  double (*q)[3];
  double gravity[3];
} woven_reference;

FIXTURE void woven_reference_open(woven_reference *s, const fray_world *w) {
  const params *p = w->params;
  s->w = w;
  s->held = (uint32_t)p->attached;
  s->particles = (uint32_t)p->particles;
  s->x = calloc(s->particles, sizeof *s->x);
  s->v = calloc(s->particles, sizeof *s->v);
  s->q = calloc(s->particles, sizeof *s->q);
  if (s->x == NULL || s->v == NULL || s->q == NULL) fixture_give_up("double sheet", "memory");
  const int32_t *const x[3] = {w->p.x, w->p.y, w->p.z};
  const int32_t *const v[3] = {w->p.vx, w->p.vy, w->p.vz};
  const int8_t *const r[3] = {w->p.rx, w->p.ry, w->p.rz};
  for (uint32_t n = 0; n < s->particles; ++n)
    for (uint32_t a = 0; a < 3; ++a) {
      s->x[n][a] = x[a][n] * 0x1p-24 + r[a][n] * 0x1p-28;
      s->v[n][a] = v[a][n] * 0x1p-28;
    }
  s->gravity[0] = p->gravity_x * 0x1p-28 + (uint32_t)p->gravity_rest_x * 0x1p-60;
  s->gravity[1] = p->gravity_y * 0x1p-28 + (uint32_t)p->gravity_rest_y * 0x1p-60;
  s->gravity[2] = p->gravity_z * 0x1p-28 + (uint32_t)p->gravity_rest_z * 0x1p-60;
}

FIXTURE void woven_reference_close(woven_reference *s) {
  free(s->x);
  free(s->v);
  free(s->q);
}

FIXTURE void woven_reference_springs(woven_reference *s) {
  const fray_world *w = s->w;
  for (uint32_t row = (uint32_t)w->params->links; row < w->capacity[POOL_SPRINGS]; ++row) {
    const uint32_t i = w->woven.spring_i[row];
    const uint32_t j = w->woven.spring_j[row];
    const bend_shear_class *c = &w->woven.bend_shear_classes[w->woven.spring_kind[row]];
    if (w->woven.spring_kind[row] == SPRING_DEAD || !fixture_spring_moves(w, row)) continue;
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

/* woven/strain_limit.c: f = u psi(u), of both ends; a compressed link gets its share of it. */
FIXTURE double woven_reference_factor(double n, const link_class *c) {
  const double rest = c->rest * 0x1p-24;
  const double u = fmax(fmin(n / (rest * rest) - 1, 9.0 / 16), -7.0 / 16);
  const double psi = (16384 + u * (-12648 + u * 9961)) / 65536;
  return u * psi * (u < 0 ? c->push / 4096.0 : 1);
}

FIXTURE void woven_reference_project(woven_reference *s) {
  const fray_world *w = s->w;
  for (uint32_t row = 0; row < (uint32_t)w->params->links; ++row) {
    const uint32_t i = w->woven.spring_i[row];
    const uint32_t j = w->woven.spring_j[row];
    if (w->woven.spring_kind[row] == SPRING_DEAD || j < s->held) continue;
    double d[3];
    double n = 0;
    for (uint32_t a = 0; a < 3; ++a) {
      d[a] = s->x[j][a] - s->x[i][a];
      n += d[a] * d[a];
    }
    const double f = woven_reference_factor(n, &w->woven.link_classes[w->woven.spring_kind[row]]);
    for (uint32_t a = 0; a < 3; ++a) {
      if (i >= s->held) s->x[i][a] += f * d[a];
      s->x[j][a] -= (i >= s->held ? 1 : 2) * f * d[a];
    }
  }
}

FIXTURE void woven_reference_tick(woven_reference *s) {
  const params *p = s->w->params;
  const double kept = 1 - p->drag * 0x1p-24;
  for (uint32_t n = s->held; n < s->particles; ++n)
    for (uint32_t a = 0; a < 3; ++a) s->v[n][a] *= kept;
  woven_reference_springs(s);
  for (int32_t substep = 0; substep < p->substeps; ++substep) {
    for (uint32_t n = s->held; n < s->particles; ++n)
      for (uint32_t a = 0; a < 3; ++a) {
        s->v[n][a] += s->gravity[a];
        s->q[n][a] = s->x[n][a] += s->v[n][a];
      }
    for (int32_t sweep = 0; sweep < p->iterations; ++sweep) woven_reference_project(s);
    for (uint32_t n = s->held; n < s->particles; ++n)
      for (uint32_t a = 0; a < 3; ++a) s->v[n][a] += s->x[n][a] - s->q[n][a];
  }
}

/* Root of the mean squared distance over free particles, in lu. */
FIXTURE double woven_reference_distance(const woven_reference *a, const woven_reference *b) {
  double sum = 0;
  for (uint32_t n = a->held; n < a->particles; ++n)
    for (uint32_t k = 0; k < 3; ++k) sum += (a->x[n][k] - b->x[n][k]) * (a->x[n][k] - b->x[n][k]);
  return sqrt(sum / (a->particles - a->held));
}
FIXTURE double woven_reference_error(const woven_reference *s, const fray_world *w) {
  woven_reference other;
  woven_reference_open(&other, w);
  const double distance = woven_reference_distance(s, &other);
  woven_reference_close(&other);
  return distance;
}

#endif
