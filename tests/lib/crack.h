/* SPDX-License-Identifier: Apache-2.0 */
/* What a membrane's tears look like, in rest coordinates: their length by direction, how many
 * there are, where each is. Angles are those against the warp: 0 is along it, 90 along the weft. */
#ifndef FRAY_TESTS_LIB_CRACK_H
#define FRAY_TESTS_LIB_CRACK_H

#include "tests/lib/world_fixture.h"

enum { CRACK_DIRECTIONS = 4, CRACKS_MAX = 256 };

/* One tear: torn sides that hang together. Lengths in cm. */
typedef struct {
  double length, along_u, along_v; /* along_u: sum of the parts of its sides along the weft */
  double low[2], high[2];          /* the rectangle it is in: u, v */
} crack;

typedef struct {
  double length;            /* of all */
  double share[CRACK_DIRECTIONS]; /* of it within 22.5 degrees of 0, 45, 90, 135 */
  double flat;              /* how far along the weft what is nearer to the weft than to the warp goes */
  uint32_t cracks;
  crack crack[CRACKS_MAX];  /* the longest first */
} crack_map;

typedef struct {
  uint32_t *parent;
  uint32_t *order; /* particles by their place at rest */
} crack_sets;

static const trimesh *crack_sheet; /* for qsort */
FIXTURE int crack_by_place(const void *a, const void *b) {
  const uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
  if (crack_sheet->u[p] != crack_sheet->u[q]) return crack_sheet->u[p] < crack_sheet->u[q] ? -1 : 1;
  if (crack_sheet->v[p] != crack_sheet->v[q]) return crack_sheet->v[p] < crack_sheet->v[q] ? -1 : 1;
  return p < q ? -1 : p > q;
}

FIXTURE uint32_t crack_root(crack_sets *s, uint32_t p) {
  while (s->parent[p] != p) p = s->parent[p] = s->parent[s->parent[p]];
  return p;
}
FIXTURE void crack_join(crack_sets *s, uint32_t p, uint32_t q) {
  s->parent[crack_root(s, p)] = crack_root(s, q);
}

/* What was one vertex is one place. */
FIXTURE void crack_open_sets(crack_sets *s, const fray_world *w) {
  s->parent = malloc(w->p.count * sizeof *s->parent);
  s->order = malloc(w->p.count * sizeof *s->order);
  if (s->parent == NULL || s->order == NULL) fixture_give_up("crack", "out of memory");
  for (uint32_t p = 0; p < w->p.count; ++p) s->parent[p] = s->order[p] = p;
  crack_sheet = &w->trimesh;
  qsort(s->order, w->p.count, sizeof *s->order, crack_by_place);
  for (uint32_t n = 1; n < w->p.count; ++n) {
    const uint32_t p = s->order[n - 1], q = s->order[n];
    if (w->trimesh.u[p] == w->trimesh.u[q] && w->trimesh.v[p] == w->trimesh.v[q]) crack_join(s, p, q);
  }
}

FIXTURE void crack_add_edge(crack_map *m, crack *c, const double a[2], const double b[2]) {
  const double du = b[0] - a[0], dv = b[1] - a[1];
  const double half = hypot(du, dv) / 2; /* each side of a tear is there twice */
  double angle = atan2(du, dv) * 180 / 3.14159265358979323846;
  if (angle < 0) angle += 180;
  m->length += half;
  m->share[(uint32_t)((angle + 22.5) / 45) % CRACK_DIRECTIONS] += half;
  if (fabs(du) > fabs(dv)) m->flat += fabs(du) / 2;
  c->length += half;
  c->along_u += fabs(du) / 2;
  c->along_v += fabs(dv) / 2;
  for (uint32_t k = 0; k < 2; ++k) {
    c->low[k] = fmin(c->low[k], fmin(a[k], b[k]));
    c->high[k] = fmax(c->high[k], fmax(a[k], b[k]));
  }
}

/* How many tears lie side by side, as a line across them meets them: of lines a third of a cell apart, the
 * most that a tenth of those that meet any meet. axis 0: lines along the weft, so tears along the warp. */
FIXTURE uint32_t crack_parallel_count(const fixture *f, uint32_t axis, double apart_cm) {
  enum { LINES = 1024, MOST = 64 };
  const trimesh *s = &f->w->trimesh;
  const int32_t *at = axis == 0 ? s->v : s->u;
  const double per_line = fixture_lu_cm(f) * 0x1p-24 / apart_cm;
  static uint32_t lips[LINES];
  uint32_t met[MOST] = {0}, all = 0, most = 0;
  memset(lips, 0, sizeof lips);
  for (uint32_t n = 0; n < 3 * (uint32_t)s->state->triangles; ++n) {
    const uint32_t t = n / 3, k = n % 3;
    if (trimesh_mark_of(s, t, k) != TRIMESH_TORN) continue;
    const double a = at[s->triangle[t].v[trimesh_next(k)]] * per_line;
    const double b = at[s->triangle[t].v[trimesh_previous(k)]] * per_line;
    for (int32_t line = (int32_t)ceil(fmin(a, b) - 0.41); line + 0.41 <= fmax(a, b); ++line)
      ++lips[line + LINES / 2];
  }
  for (uint32_t n = 0; n < LINES; ++n) {
    all += lips[n] != 0;
    for (uint32_t k = 1; k < MOST; ++k) met[k] += lips[n] / 2 >= k;
  }
  for (uint32_t k = 1; k < MOST; ++k)
    if (met[k] != 0 && met[k] * 10 >= all) most = k;
  return most;
}

FIXTURE int crack_longer(const void *a, const void *b) {
  const crack *p = (const crack *)a, *q = (const crack *)b;
  return p->length > q->length ? -1 : p->length < q->length;
}

FIXTURE uint32_t crack_of(crack_map *m, uint32_t *number, uint32_t root) {
  if (number[root] != UINT32_MAX) return number[root];
  if (m->cracks == CRACKS_MAX) fixture_give_up("crack", "too many");
  crack *c = &m->crack[m->cracks];
  memset(c, 0, sizeof *c);
  c->low[0] = c->low[1] = 1e9;
  c->high[0] = c->high[1] = -1e9;
  return number[root] = m->cracks++;
}

FIXTURE void crack_find(crack_map *m, const fixture *f) {
  const fray_world *w = f->w;
  const trimesh *s = &w->trimesh;
  const double cm = fixture_lu_cm(f) * 0x1p-24;
  crack_sets sets;
  memset(m, 0, sizeof *m);
  crack_open_sets(&sets, w);
  uint32_t *number = malloc(w->p.count * sizeof *number);
  if (number == NULL) fixture_give_up("crack", "out of memory");
  for (uint32_t p = 0; p < w->p.count; ++p) number[p] = UINT32_MAX;
  for (uint32_t pass = 0; pass < 2; ++pass)
    for (uint32_t n = 0; n < 3 * (uint32_t)s->state->triangles; ++n) {
      const uint32_t t = n / 3, k = n % 3;
      if (trimesh_mark_of(s, t, k) != TRIMESH_TORN) continue;
      const uint32_t a = s->triangle[t].v[trimesh_next(k)], b = s->triangle[t].v[trimesh_previous(k)];
      if (pass == 0) {
        crack_join(&sets, a, b);
        continue;
      }
      const double from[2] = {s->u[a] * cm, s->v[a] * cm}, to[2] = {s->u[b] * cm, s->v[b] * cm};
      crack_add_edge(m, &m->crack[crack_of(m, number, crack_root(&sets, a))], from, to);
    }
  for (uint32_t n = 0; n < CRACK_DIRECTIONS && m->length > 0; ++n) m->share[n] /= m->length;
  qsort(m->crack, m->cracks, sizeof m->crack[0], crack_longer);
  free(sets.parent);
  free(sets.order);
  free(number);
}

#endif
