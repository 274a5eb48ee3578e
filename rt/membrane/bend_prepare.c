/* SPDX-License-Identifier: Apache-2.0 */
/* What bending steps multiply by, once a tick, for bend_force.c. SIMD twin: rt/simd/bend_prepare_lanes.inl.h.
 *
 *   H_ij     = e_i e_j / A N_i C N_j, N = (n_u^2, n_v^2, 2 n_u n_v) of the outward normals of sides at rest:
 *            half of delta H delta is the energy of a plate with the curvature sum of e N delta / A. C is
 *            diagonal (a strip that bends does not bend across itself): material_table.bend, at the habit of
 *            the triangle's curvature, linear between the curvatures of the table. A C of the present
 *            curvature is no energy's derivative, and feeds folds that tremble
 *   border   A side on the boundary has no moment: its delta is what makes the energy least, which takes it
 *            out, H_ij -= H_ib H_bj / H_bb. So opening a side never raises the energy
 *   g_ki     = -(e_k . e_i) / (|e_k| |N|) of sides as they are now: moments along them have no sum but in
 *            rounding
 *   fade     the least of 2 A / A_rest, 5/4 of its heights over those at rest, and 1: what is left of a
 *            triangle that is pressed together, or drawn thin. A fold's angle counts by the fade of both its
 *            triangles, so that forces stay bounded by those of half the area, and frequencies by 5/4 of
 *            those at rest: drawn sheets and strips that were pressed flat gained energy without end
 *
 * H is worked out anew where tears changed the mesh or a cloth's stiffness varies, borders and folds only
 * then (bend_folds.c). */
#include "rt/membrane/membrane.h"
#include "rt/simd/simd.h"

static vec3 edge_vector(const plate_view *view, uint32_t from, uint32_t to) {
  const int32_t *const *at = view->at;
  const vec3 d = vec_sub(vec_at(at[0], at[1], at[2], to), vec_at(at[0], at[1], at[2], from));
  return vec_mul(vec_clamp_rare(d, BEND_REACH / 16), 16);
}

static void store_geometry(const plate_view *view, uint32_t t, const int32_t g[6], int32_t fade) {
  for (uint32_t n = 0; n < 6; ++n) view->plates[(PLATE_G01 + n) * view->stride + t] = g[n];
  view->plates[PLATE_FADE * view->stride + t] = fade;
}

/* A length along a side in Q28 over |N|: Q16 of 1 / lu. */
static int32_t over_normal(fx_root normal, int32_t length) {
  return fx_saturate(fx_root_over(normal, length, 16));
}

static int32_t fade_of(const plate_view *view, uint32_t t, uint32_t normal, const uint32_t length[3]) {
  const uint32_t area = view->area[t];
  const uint64_t twice = (uint64_t)normal << 2; /* the area, Q30 */
  int32_t fade = twice >= area ? BEND_ONE : (int32_t)fx_divide_wide(twice << 30, area);
  for (uint32_t k = 0; k < 3; ++k)
    fade = fx_min(fade, bend_fade_by_height(&view->shapes[t], k, normal, length[k]));
  return fade;
}

/* Returns whether it is pressed together. */
static int prepare_triangle(const plate_view *view, uint32_t t) {
  const index_t *v = view->triangle[t].v;
  const vec3 e2 = edge_vector(view, v[0], v[1]);
  const vec3 d2 = edge_vector(view, v[0], v[2]);
  const vec3 e0 = vec_sub(d2, e2);
  const vec3 e1 = vec_negated(d2);
  const vec3 normal = vec_cross_q28(e2, d2);
  const uint64_t squared = vec_squared(normal);
  static const int32_t none[6] = {0, 0, 0, 0, 0, 0};
  if (squared < BEND_FLAT) {
    store_geometry(view, t, none, 0);
    return 1;
  }
  const fx_root over = fx_rsqrt(squared, FX_ROOT_FINE);
  const fx_root r0 = fx_rsqrt(vec_squared(e0), FX_ROOT_FINE);
  const fx_root r1 = fx_rsqrt(vec_squared(e1), FX_ROOT_FINE);
  const fx_root r2 = fx_rsqrt(vec_squared(e2), FX_ROOT_FINE);
  const int32_t e01 = fx_saturate(fx_round64(vec_dot64(e0, e1), 28));
  const int32_t e02 = fx_saturate(fx_round64(vec_dot64(e0, e2), 28));
  const int32_t e12 = fx_saturate(fx_round64(vec_dot64(e1, e2), 28));
  const int32_t g[6] = {-over_normal(over, fx_saturate(fx_root_over(r0, e01, 28))),
                        -over_normal(over, fx_saturate(fx_root_over(r0, e02, 28))),
                        -over_normal(over, (int32_t)fx_root_length(r1)),
                        -over_normal(over, fx_saturate(fx_root_over(r1, e12, 28))),
                        -over_normal(over, fx_saturate(fx_root_over(r2, e12, 28))),
                        -over_normal(over, (int32_t)fx_root_length(r2))};
  const uint32_t length[3] = {fx_root_length(r0), fx_root_length(r1), fx_root_length(r2)};
  const int32_t fade = fade_of(view, t, fx_root_length(over), length);
  store_geometry(view, t, g, fade);
  return fade != BEND_ONE;
}

/* ---- H ---- */

/* C at this curvature, Q24 of steps of the table. */
static void find_stiffness(const material_table *f, int32_t curvature, int32_t c[3]) {
  const uint32_t step = (uint32_t)fx_min(curvature >> BEND_HABIT_BITS, MATERIAL_CURVES - 1);
  const uint32_t next = step + 1u < MATERIAL_CURVES ? step + 1u : step;
  const int32_t part = curvature & ((1 << BEND_HABIT_BITS) - 1);
  for (uint32_t n = 0; n < 3; ++n)
    c[n] = f->bend[n][step] + fx_mul_round(fx_sub(f->bend[n][next], f->bend[n][step]), part, BEND_HABIT_BITS);
}

static void stiffen_triangle(const plate_view *view, uint32_t t) {
  const int32_t(*const side)[3] = (const int32_t(*)[3])view->shapes[t].side;
  int32_t c[3];
  int32_t scaled[3][3]; /* by C */
  FRAY_ASSERT(view->material[t] < MAX_MATERIALS);
  find_stiffness(&view->materials[view->material[t]], view->states[t].habit[SMOOTHED_STRAIN_POLES - 1], c);
  for (uint32_t k = 0; k < 3; ++k)
    for (uint32_t n = 0; n < 3; ++n) scaled[k][n] = fx_mul_saturated(c[n], side[k][n], 27);
  static const uint8_t rows[6] = {0, 1, 2, 0, 0, 1};
  static const uint8_t columns[6] = {0, 1, 2, 1, 2, 2};
  for (uint32_t h = 0; h < 6; ++h) {
    const int32_t *a = scaled[rows[h]];
    const int32_t *b = side[columns[h]];
    const int64_t sum = fx_mul_wide(a[0], b[0]) + fx_mul_wide(a[1], b[1]) + fx_mul_wide(a[2], b[2]);
    view->plates[h * view->stride + t] = fx_clamp_wide(fx_round64(sum, 25), BEND_ENTRY_MAX);
  }
}

/* a b / d to the nearest. */
static int32_t product_over(int32_t a, int32_t b, int32_t d) {
  const int64_t product = fx_mul_wide(a, b);
  const uint64_t size = (uint64_t)(product < 0 ? -product : product) + (uint32_t)d / 2u;
  const int32_t quotient = fx_saturate((int64_t)fx_divide_wide(size, (uint32_t)d));
  return product < 0 ? -quotient : quotient;
}

/* Takes side b of a triangle out of its H. */
static void take_out(fray_world *w, uint32_t t, uint32_t b) {
  static const uint8_t entry[3][3] = {{PLATE_H00, PLATE_H01, PLATE_H02},
                                      {PLATE_H01, PLATE_H11, PLATE_H12},
                                      {PLATE_H02, PLATE_H12, PLATE_H22}};
  const uint32_t i = trimesh_next(b);
  const uint32_t j = trimesh_previous(b);
  int32_t *const ii = &bend_plate_column(w, entry[i][i])[t];
  int32_t *const jj = &bend_plate_column(w, entry[j][j])[t];
  int32_t *const ij = &bend_plate_column(w, entry[i][j])[t];
  int32_t *const bb = &bend_plate_column(w, entry[b][b])[t];
  int32_t *const ib = &bend_plate_column(w, entry[i][b])[t];
  int32_t *const jb = &bend_plate_column(w, entry[j][b])[t];
  if (*bb > 0) {
    *ii = fx_max(*ii - product_over(*ib, *ib, *bb), 0);
    *jj = fx_max(*jj - product_over(*jb, *jb, *bb), 0);
    *ij = *ij - product_over(*ib, *jb, *bb);
  }
  *bb = *ib = *jb = 0;
}

static void take_out_borders(fray_world *w) {
  const trimesh_triangle *triangle = w->trimesh.triangle;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (triangle[t].neighbour[k] == t) take_out(w, t, k);
}

static int stiffness_varies(const fray_world *w) {
  int32_t other = 0;
  for (uint32_t m = 0; m < (uint32_t)w->trimesh.params->materials; ++m)
    for (uint32_t n = 0; n < 3; ++n)
      for (uint32_t k = 1; k < MATERIAL_CURVES; ++k)
        other |= w->membrane.materials[m].bend[n][k] ^ w->membrane.materials[m].bend[n][0];
  return other != 0;
}

/* ---- the habit of the curvature ---- */

/* Eight times slower than that of the strain, half a second: a stiffness that follows folds as they move lags
 * behind them, and where it grows with the curvature it gives them more than it took. With 64 ms a falling
 * sheet
 * gained a sixth, with this a thirtieth. */
enum { HABIT_SLOWER = 3 };

static void lowpass(int32_t *mean, int32_t to, unsigned shift) {
  *mean += (int32_t)fx_round64((int64_t)to - *mean, shift);
}

/* Frobenius norm of the curvature, in steps of the table, from the angles of a bending step. */
static int32_t curvature_of(const fray_world *w, uint32_t t) {
  const bend_shape *shape = &w->membrane.bend_shapes[t];
  const int32_t *angle = w->membrane.moments[t].side;
  int32_t bent[3]; /* times root(A), Q24 */
  for (uint32_t n = 0; n < 3; ++n)
    bent[n] = fx_clamp_wide(fx_round64(fx_mul_wide(shape->side[0][n], angle[0]) +
                                           fx_mul_wide(shape->side[1][n], angle[1]) +
                                           fx_mul_wide(shape->side[2][n], angle[2]),
                                       30),
                            1 << 29);
  const uint64_t squared = fx_square(bent[0]) + fx_square(bent[1]) + (fx_square(bent[2]) >> 1);
  if (squared == 0) return 0;
  const int32_t norm = (int32_t)fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
  const int32_t by_lu = fx_mul_saturated(norm, shape->inverse_root, 16);
  return fx_clamp_wide(fx_round64(fx_mul_wide(by_lu, w->membrane.constants->curve_gain), 24), BEND_HABIT_MAX);
}

void bend_habit_update(fray_world *w) {
  const unsigned shift = (unsigned)w->membrane.constants->smoothing_shift + HABIT_SLOWER;
  FRAY_ASSERT(world_has_membrane(w));
  if (!stiffness_varies(w)) return;
  for (uint32_t t = 0; t < triangles_in_use(w); ++t) {
    int32_t *habit = w->membrane.bend_states[t].habit;
    lowpass(&habit[0], curvature_of(w, t), shift);
    lowpass(&habit[1], habit[0], shift);
  }
}

void bend_offsets_store(fray_world *w) {
  for (uint32_t n = 0; n < w->membrane.fold_count; ++n) {
    const uint32_t first = (uint32_t)bend_fold_column(w, FOLD_FIRST)[n];
    const uint32_t second = (uint32_t)bend_fold_column(w, FOLD_SECOND)[n];
    const int32_t offset = bend_fold_column(w, FOLD_OFFSET)[n];
    w->membrane.bend_states[first / 4u].offset[first % 4u] = offset;
    w->membrane.bend_states[second / 4u].offset[second % 4u] = -offset;
  }
}

void bend_offsets_load(fray_world *w) {
  for (uint32_t n = 0; n < w->membrane.fold_count; ++n) {
    const uint32_t first = (uint32_t)bend_fold_column(w, FOLD_FIRST)[n];
    bend_fold_column(w, FOLD_OFFSET)[n] = w->membrane.bend_states[first / 4u].offset[first % 4u];
  }
}

/* ---- a tick ---- */

static void hold_folds(fray_world *w) {
  const int32_t *fade = bend_plate_column(w, PLATE_FADE);
  for (uint32_t n = 0; n < w->membrane.fold_count; ++n) {
    const uint32_t t = (uint32_t)bend_fold_column(w, FOLD_FIRST)[n] / 4u;
    const uint32_t o = (uint32_t)bend_fold_column(w, FOLD_SECOND)[n] / 4u;
    bend_fold_column(w, FOLD_HOLD)[n] =
        fx_mul_round(fx_mul_round(bend_fold_column(w, FOLD_CAP)[n], fade[t], 30), fade[o], 30);
  }
}

void bend_prepare(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w));
  const plate_view view = {{w->p.x, w->p.y, w->p.z}, w->trimesh.triangle, w->trimesh.area,
                           w->membrane.bend_shapes,  w->trimesh.material, w->membrane.materials,
                           w->membrane.bend_states,  w->membrane.plates,  w->capacity[POOL_TRIANGLES]};
  const uint32_t count = triangles_in_use(w);
  const int is_new = w->membrane.bend_current == 0;
  uint32_t faded = 0;
  if (w->membrane.constants->bend_every == 0) return;
  if (is_new) (void)bend_folds_find(w);
  w->membrane.bend_current = 1;
  if (is_new || stiffness_varies(w)) {
    for (uint32_t t = 0; t < count;) {
      t += simd_bend_stiffness(w->kernel, &view, t, count);
      if (t < count) stiffen_triangle(&view, t++);
    }
    take_out_borders(w);
  }
  for (uint32_t t = 0; t < count;) {
    t += simd_bend_geometry(w->kernel, &view, t, count);
    if (t < count) faded |= (uint32_t)prepare_triangle(&view, t++);
  }
  if ((faded | w->membrane.bend_faded) != 0) hold_folds(w);
  w->membrane.bend_faded = faded != 0;
}
