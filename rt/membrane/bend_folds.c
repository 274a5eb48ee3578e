/* SPDX-License-Identifier: Apache-2.0 */
/* The folds of a membrane, sides between two triangles, whenever tears and cuts have changed them: where they
 * are, how their angle is divided, how fast offsets are relaxed, and the cap of small triangles.
 *
 *   share    a = A / (A + A'): the smaller triangle is the stiffer one, and folds less
 *   rate     r = 3/5 / (d + d'), d = H_kk before sides of the boundary are taken out, at the stiffest
 *            curvature. The offsets' matrix has the diagonal d + d'; a triangle adds at most three times its
 *            own diagonal (the trace), so a factor below 2/3 is stable for any triangles
 *   cap      With phi held the energy is at most mu / 2 times the sum of K theta^2, K = d d' / (d + d') (both
 *            in series), mu <= 3. theta is g . x along normals, so no eigenvalue of M^-1 K is above the
 *            largest row
 *              R_i = 1 / m_i sum over folds at i of K |g_i| sum_j |g_j|
 *            (but for mu, which is the same everywhere). R0 is that of the mesh as built, which bending
 *            steps are made for: the angle of a fold with a larger row at any of its four vertices counts
 *            R0 / R. Its square bounds the row, and more: phi lags a step behind, and triangles move. */
#include "rt/base/bytes.h"
#include "rt/membrane/membrane.h"

enum {
  GRADIENT_BITS = 10, /* 1 / lu */
  GRADIENT_MAX = 1 << 24,
  ROW_BITS = 24,          /* by a mass of Q30 lu^2 */
  FRACTION_MAX = 16 << 16 /* Q16: of a foot */
};

/* H_kk, before sides of the boundary are taken out; in the format of the stiffness. */
static int32_t diagonal(const int32_t c[3], const int32_t side[3]) {
  int64_t sum = 0;
  for (uint32_t n = 0; n < 3; ++n) sum += fx_mul_wide(fx_mul_saturated(c[n], side[n], 27), side[n]);
  return fx_clamp_wide(fx_round64(sum, 25), BEND_ENTRY_MAX);
}

static void find_stiffest(const material_table *f, int32_t c[3]) {
  for (uint32_t n = 0; n < 3; ++n) {
    c[n] = f->bend[n][0];
    for (uint32_t k = 1; k < MATERIAL_CURVES; ++k) c[n] = fx_max(c[n], f->bend[n][k]);
  }
}

static int32_t diagonal_of(const fray_world *w, uint32_t place) {
  int32_t c[3];
  find_stiffest(&w->membrane.materials[w->trimesh.material[place / 4u]], c);
  return diagonal(c, w->membrane.bend_shapes[place / 4u].side[place % 4u]);
}

/* 1 / h of the corner opposite a side, at rest, Q10 of 1 / lu: e / 2 A. */
static int32_t inverse_height(const bend_shape *shape, uint32_t k) {
  const int32_t length = fx_add_saturated(shape->side[k][0], shape->side[k][1]);
  return fx_clamp_wide(fx_round64(fx_mul_wide(length, shape->inverse_root), 26 + 16 + 1 - GRADIENT_BITS),
                       GRADIENT_MAX);
}

/* Where the height of corner k meets its side at rest: 0 at corner k + 1, 1 at k + 2, Q16. */
static int32_t foot_of(const trimesh *s, uint32_t t, uint32_t k) {
  const index_t *v = s->triangle[t].v;
  const trimesh_point a = trimesh_at(s, v[trimesh_next(k)]);
  const trimesh_point b = trimesh_at(s, v[trimesh_previous(k)]);
  const trimesh_point c = trimesh_at(s, v[k]);
  const int32_t u = fx_sub(b.u, a.u);
  const int32_t w = fx_sub(b.v, a.v);
  const int64_t dot = fx_add64(fx_mul_wide(u, fx_sub(c.u, a.u)), fx_mul_wide(w, fx_sub(c.v, a.v)));
  const uint64_t squared = fx_square(u) + fx_square(w);
  const unsigned down = fx_leading_zeros64(squared | 1u) < 33u ? 33u - fx_leading_zeros64(squared | 1u) : 0;
  const uint64_t size = (uint64_t)(dot < 0 ? -dot : dot) >> down;
  const uint32_t part =
      size >> 36 != 0 ? UINT32_MAX : fx_divide_wide(size << 16, (uint32_t)(squared >> down));
  const int32_t foot = part > FRACTION_MAX ? FRACTION_MAX : (int32_t)part;
  return dot < 0 ? -foot : foot;
}

/* Sizes of the gradient of a fold's angle: at the vertex opposite it in the first triangle, at corners k + 1
 * and k + 2 of that, and opposite in the second; Q10 of 1 / lu. */
static void find_gradient(const fray_world *w, uint32_t first, uint32_t second, uint32_t size[4]) {
  const uint32_t place[2] = {first, second};
  int32_t ends[2] = {0, 0};
  for (uint32_t n = 0; n < 2; ++n) {
    const uint32_t t = place[n] / 4u;
    const uint32_t k = place[n] % 4u;
    const int32_t g = inverse_height(&w->membrane.bend_shapes[t], k);
    const int32_t last = (int32_t)fx_round64(fx_mul_wide(g, foot_of(&w->trimesh, t, k)), 16);
    size[3u * n] = fx_magnitude(g);
    ends[n] += g - last;
    ends[1u - n] += last;
  }
  size[1] = fx_magnitude(ends[0]);
  size[2] = fx_magnitude(ends[1]);
}

static void vertices_of(const fray_world *w, uint32_t n, uint32_t vertex[4]) {
  const uint32_t first = (uint32_t)bend_fold_column(w, FOLD_FIRST)[n];
  const index_t *v = w->trimesh.triangle[first / 4u].v;
  vertex[0] = v[first % 4u];
  vertex[1] = v[trimesh_next(first % 4u)];
  vertex[2] = v[trimesh_previous(first % 4u)];
  vertex[3] = (uint32_t)bend_fold_column(w, FOLD_OPPOSITE)[n];
}

/* d d' / (d + d'). */
static uint32_t in_series(int32_t d1, int32_t d2) {
  return d1 + d2 == 0 ? 0 : fx_divide_wide((uint64_t)fx_mul_wide(d1, d2), (uint32_t)(d1 + d2));
}

/* Adds the fold to the sums of its vertices' rows. */
static void add_rows(fray_world *w, uint32_t n, int32_t d1, int32_t d2) {
  const uint64_t stiff = in_series(d1, d2);
  const unsigned shift = (unsigned)w->membrane.constants->bend_row_shift;
  uint32_t size[4];
  uint32_t vertex[4];
  find_gradient(w, (uint32_t)bend_fold_column(w, FOLD_FIRST)[n],
                (uint32_t)bend_fold_column(w, FOLD_SECOND)[n], size);
  vertices_of(w, n, vertex);
  const uint64_t whole = (uint64_t)size[0] + size[1] + size[2] + size[3];
  for (uint32_t k = 0; k < 4; ++k) {
    uint64_t product = size[k] * whole >> (2 * GRADIENT_BITS - 8);
    product = product > INT32_MAX ? INT32_MAX : product;
    const uint64_t row = stiff * product >> shift;
    int32_t *sum = &w->membrane.impulse[vertex[k]].x;
    *sum = fx_add_saturated(*sum, row > INT32_MAX ? INT32_MAX : (int32_t)row);
  }
}

static void add_fold(fray_world *w, uint32_t n, uint32_t t, uint32_t k) {
  enum { RATE_ONE = 50 };
  const trimesh *s = &w->trimesh;
  const uint32_t other = s->triangle[t].neighbour[k];
  const uint32_t back = trimesh_neighbour_edge(s, t, k);
  const int32_t d1 = diagonal_of(w, 4u * t + k);
  const int32_t d2 = diagonal_of(w, 4u * other + back);
  const uint32_t rate = fx_divide_wide(((uint64_t)1 << RATE_ONE) / 5u * 3u, (uint32_t)(d1 + d2));
  FRAY_ASSERT(s->area[t] > 0 && s->area[other] > 0);
  bend_fold_column(w, FOLD_FIRST)[n] = (int32_t)(4u * t + k);
  bend_fold_column(w, FOLD_SECOND)[n] = (int32_t)(4u * other + back);
  bend_fold_column(w, FOLD_BASE)[n] = (int32_t)s->triangle[t].v[k];
  bend_fold_column(w, FOLD_OPPOSITE)[n] = (int32_t)s->triangle[other].v[back];
  bend_fold_column(w, FOLD_SHARE)[n] =
      (int32_t)fx_divide_wide((uint64_t)s->area[t] << 30, s->area[t] + s->area[other]);
  bend_fold_column(w, FOLD_RATE)[n] = rate > INT32_MAX ? INT32_MAX : (int32_t)rate;
  bend_fold_column(w, FOLD_OFFSET)[n] = w->membrane.bend_states[t].offset[k];
  add_rows(w, n, d1, d2);
}

/* Sums to rows; returns the largest. */
static uint32_t finish_rows(fray_world *w) {
  uint32_t most = 0;
  for (uint32_t p = 0; p < w->p.count; ++p) {
    FRAY_ASSERT(w->trimesh.mass[p] > 0 && w->membrane.impulse[p].x >= 0);
    const uint32_t row = fx_divide_wide((uint64_t)w->membrane.impulse[p].x << ROW_BITS, w->trimesh.mass[p]);
    w->membrane.impulse[p].x = row > INT32_MAX ? INT32_MAX : (int32_t)row;
    if (row > most) most = row;
  }
  return most;
}

static int32_t cap_of(const fray_world *w, uint32_t n) {
  const int32_t most = w->membrane.constants->bend_row_max;
  int32_t row = 0;
  uint32_t vertex[4];
  vertices_of(w, n, vertex);
  for (uint32_t k = 0; k < 4; ++k) row = fx_max(row, w->membrane.impulse[vertex[k]].x);
  return row <= most ? BEND_ONE : (int32_t)fx_divide_wide((uint64_t)most << 30, (uint32_t)row);
}

uint32_t bend_folds_find(fray_world *w) {
  const trimesh *s = &w->trimesh;
  uint32_t count = 0;
  FRAY_ASSERT(w->p.count <= w->capacity[POOL_PARTICLES]);
  for (uint32_t p = 0; p < w->p.count; ++p) w->membrane.impulse[p].x = 0;
  /* the angle of a side on the boundary is none: no step writes it */
  bytes_zero(w->membrane.moments, triangles_in_use(w) * sizeof *w->membrane.moments);
  for (uint32_t t = 0; t < triangles_in_use(w); ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (s->triangle[t].neighbour[k] > t) add_fold(w, count++, t, k);
  FRAY_ASSERT(2u * count <= 3u * w->capacity[POOL_TRIANGLES]);
  w->membrane.fold_count = count;
  const uint32_t most = finish_rows(w);
  for (uint32_t n = 0; n < count; ++n)
    bend_fold_column(w, FOLD_CAP)[n] = bend_fold_column(w, FOLD_HOLD)[n] = cap_of(w, n);
  return most;
}
