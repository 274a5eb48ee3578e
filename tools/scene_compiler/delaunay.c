/* SPDX-License-Identifier: Apache-2.0 */
/* Delaunay triangulation by insertion (Bowyer, Watson 1981): triangles with the new point inside their
 * circumcircle are replaced by a fan around it. Points are rounded to a grid of 2^14 steps first, so that every
 * decision is exact in 64 bits; at ties (four corners of a square on a circle) the older triangle stays. */
#include <stdlib.h>
#include <string.h>

#include "tools/scene_compiler/planar_mesh.h"

enum { GRID = 1 << 14, FRAME = 4 /* points of the frame around all */ };

typedef struct {
  int32_t x, y;
} spot;

typedef struct {
  spot *at;
  uint32_t (*corner)[3];
  uint32_t triangles, room;
  uint32_t (*side)[2]; /* of the hole */
  uint32_t sides;
} job;

static int64_t twice_area(spot a, spot b, spot c) {
  return (int64_t)(b.x - a.x) * (c.y - a.y) - (int64_t)(b.y - a.y) * (c.x - a.x);
}

/* Above 0 iff d lies inside of the circle of a, b, c, which are anticlockwise. Differences are
 * below 2^15.2, squares 2^31.4, the sum 2^63. */
static int64_t inside(spot a, spot b, spot c, spot d) {
  const int64_t ax = a.x - d.x;
  const int64_t ay = a.y - d.y;
  const int64_t bx = b.x - d.x;
  const int64_t by = b.y - d.y;
  const int64_t cx = c.x - d.x;
  const int64_t cy = c.y - d.y;
  return (ax * ax + ay * ay) * (bx * cy - by * cx) - (bx * bx + by * by) * (ax * cy - ay * cx) +
         (cx * cx + cy * cy) * (ax * by - ay * bx);
}

/* An edge of two triangles of the hole is inside of it. */
static void add_side(job *k, uint32_t from, uint32_t to) {
  for (uint32_t n = 0; n < k->sides; ++n)
    if (k->side[n][0] == to && k->side[n][1] == from) {
      memcpy(k->side[n], k->side[--k->sides], sizeof k->side[n]);
      return;
    }
  k->side[k->sides][0] = from;
  k->side[k->sides++][1] = to;
}

static int add(job *k, uint32_t p) {
  k->sides = 0;
  for (uint32_t t = 0; t < k->triangles;) {
    const uint32_t *c = k->corner[t];
    if (inside(k->at[c[0]], k->at[c[1]], k->at[c[2]], k->at[p]) <= 0) {
      ++t;
      continue;
    }
    for (uint32_t n = 0; n < 3; ++n) add_side(k, c[n], c[(n + 1) % 3]);
    memmove(k->corner[t], k->corner[--k->triangles], sizeof k->corner[t]);
  }
  if (k->sides == 0 || k->triangles + k->sides > k->room) return 0;
  for (uint32_t n = 0; n < k->sides; ++n) {
    uint32_t *c = k->corner[k->triangles];
    c[0] = k->side[n][0];
    c[1] = k->side[n][1];
    c[2] = p;
    k->triangles += twice_area(k->at[c[0]], k->at[c[1]], k->at[p]) > 0;
  }
  return 1;
}

/* To the grid, inside of a frame three times as wide. */
static void place(const planar_mesh *m, job *k) {
  int32_t max = 1;
  for (uint32_t p = 0; p < m->points; ++p) max = fx_max(max, fx_max(m->s[p], m->t[p]));
  for (uint32_t p = 0; p < m->points; ++p) {
    k->at[FRAME + p].x = (int32_t)((int64_t)m->s[p] * (GRID / 2) / max);
    k->at[FRAME + p].y = (int32_t)((int64_t)m->t[p] * (GRID / 2) / max);
  }
  const spot frame[FRAME] = {
      {-GRID / 2, -GRID / 2}, {GRID, -GRID / 2}, {GRID, GRID}, {-GRID / 2, GRID}};
  memcpy(k->at, frame, sizeof frame);
  const uint32_t first[2][3] = {{0, 1, 2}, {0, 2, 3}};
  memcpy(k->corner, first, sizeof first);
  k->triangles = 2;
}

static int by_numbers(const void *a, const void *b) {
  const uint32_t *p = (const uint32_t *)a;
  const uint32_t *q = (const uint32_t *)b;
  for (uint32_t n = 0; n < 3; ++n)
    if (p[n] != q[n]) return p[n] < q[n] ? -1 : 1;
  return 0;
}

/* Without the frame; lowest point first, sorted. */
static int keep(planar_mesh *m, const job *k) {
  uint32_t count = 0;
  for (uint32_t t = 0; t < k->triangles; ++t) {
    const uint32_t *c = k->corner[t];
    if (c[0] < FRAME || c[1] < FRAME || c[2] < FRAME) continue;
    uint32_t min = 0;
    for (uint32_t n = 1; n < 3; ++n)
      if (c[n] < c[min]) min = n;
    for (uint32_t n = 0; n < 3; ++n) m->corner[count][n] = c[(min + n) % 3] - FRAME;
    ++count;
  }
  m->triangles = count;
  qsort(m->corner, count, sizeof *m->corner, by_numbers);
  return count != 0;
}

int delaunay_triangulate(planar_mesh *m) {
  job k;
  memset(&k, 0, sizeof k);
  k.room = 4 * m->points + 64;
  k.at = calloc((size_t)m->points + FRAME, sizeof *k.at);
  k.corner = calloc(k.room, sizeof *k.corner);
  k.side = calloc(k.room, sizeof *k.side);
  int good = k.at != NULL && k.corner != NULL && k.side != NULL;
  if (good) place(m, &k);
  for (uint32_t p = 0; p < m->points && good; ++p) good = add(&k, FRAME + p);
  good = good && keep(m, &k);
  free(k.at);
  free(k.corner);
  free(k.side);
  return good;
}
