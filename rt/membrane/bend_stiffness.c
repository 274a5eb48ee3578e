/* SPDX-License-Identifier: Apache-2.0 */
/* H of triangles, by which bending steps multiply angles (bend_force.c). SIMD twin:
 * rt/simd/bend_prepare_lanes.inl.h.
 *
 *   H_ij     = e_i e_j / A N_i C N_j, N = (n_u^2, n_v^2, 2 n_u n_v) of the outward normals of sides at rest:
 *            half of delta H delta is the energy of a plate with the curvature sum of e N delta / A. C is
 *            diagonal (a strip that bends does not bend across itself): material_table.bend, at the habit of
 *            the triangle's curvature, linear between the curvatures of the table. A C of the present
 *            curvature is no energy's derivative, and feeds folds that tremble
 *   border   A side on the boundary has no moment: its delta is what makes the energy least, which takes it
 *            out, H_ij -= H_ib H_bj / H_bb. So opening a side never raises the energy
 *   habit    a lowpass of the curvature, of half a second: eight times slower than that of the strain. One
 *            eighth of the triangles follow in each tick, in its last bending step; what that makes is owed
 *            (bend_owed.c) */
#include "rt/membrane/membrane.h"
#include "rt/simd/simd.h"

enum { HABIT_TURNS = 8, HABIT_TURN_BITS = 3 };

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
  const uint32_t i = trimesh_next(b);
  const uint32_t j = trimesh_previous(b);
  int32_t *const ii = &bend_plate_entry(w, i, i)[t];
  int32_t *const jj = &bend_plate_entry(w, j, j)[t];
  int32_t *const ij = &bend_plate_entry(w, i, j)[t];
  int32_t *const bb = &bend_plate_entry(w, b, b)[t];
  int32_t *const ib = &bend_plate_entry(w, i, b)[t];
  int32_t *const jb = &bend_plate_entry(w, j, b)[t];
  if (*bb > 0) {
    *ii = fx_max(*ii - product_over(*ib, *ib, *bb), 0);
    *jj = fx_max(*jj - product_over(*jb, *jb, *bb), 0);
    *ij = *ij - product_over(*ib, *jb, *bb);
  }
  *bb = *ib = *jb = 0;
}

void bend_stiffen(fray_world *w, uint32_t first, uint32_t end) {
  const trimesh_triangle *triangle = w->trimesh.triangle;
  const plate_view view = bend_plate_view(w);
  FRAY_ASSERT(end <= triangles_in_use(w));
  for (uint32_t t = first; t < end;) {
    t += simd_bend_stiffness(w->kernel, &view, t, end);
    if (t < end) stiffen_triangle(&view, t++);
  }
  for (uint32_t t = first; t < end; ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (triangle[t].neighbour[k] == t) take_out(w, t, k);
}

/* ---- the habit of the curvature ---- */

static int stiffness_varies(const fray_world *w) {
  int32_t other = 0;
  for (uint32_t m = 0; m < (uint32_t)w->trimesh.params->materials; ++m)
    for (uint32_t n = 0; n < 3; ++n)
      for (uint32_t k = 1; k < MATERIAL_CURVES; ++k)
        other |= w->membrane.materials[m].bend[n][k] ^ w->membrane.materials[m].bend[n][0];
  return other != 0;
}

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

static void update_habits(fray_world *w, uint32_t first, uint32_t end) {
  const unsigned shift = (unsigned)fx_max(w->membrane.constants->smoothing_shift, 1);
  for (uint32_t t = first; t < end; ++t) {
    int32_t *habit = w->membrane.bend_states[t].habit;
    lowpass(&habit[0], curvature_of(w, t), shift);
    lowpass(&habit[1], habit[0], shift);
  }
}

/* The first triangle of this turn. */
static uint32_t turn_first(const fray_world *w, uint32_t turn) {
  return triangles_in_use(w) * turn >> HABIT_TURN_BITS;
}

void bend_follow(fray_world *w) {
  const uint32_t turn = (uint32_t)w->state->tick[0] % HABIT_TURNS;
  const uint32_t first = turn_first(w, turn);
  const uint32_t end = turn_first(w, turn + 1u);
  FRAY_ASSERT(world_has_membrane(w));
  if (!stiffness_varies(w)) return;
  bend_owed_begin(w, first, end);
  update_habits(w, first, end);
  bend_stiffen(w, first, end);
  bend_owed_end(w, first, end);
}

void bend_follow_again(fray_world *w) {
  const uint32_t turn = (uint32_t)w->state->tick[0] % HABIT_TURNS;
  FRAY_ASSERT(world_has_membrane(w));
  if (stiffness_varies(w)) bend_stiffen(w, turn_first(w, turn), turn_first(w, turn + 1u));
}
