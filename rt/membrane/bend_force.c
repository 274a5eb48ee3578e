/* SPDX-License-Identifier: Apache-2.0 */
/* Bending forces of a plate of triangles (Morley 1968; Hellan, Herrmann, Johnson), in every elastic step or
 * every few. SIMD twin: rt/simd/bend_force_lanes.inl.h.
 *
 *   theta      of a side: the angle between the normals n of its triangles, above 0 where these form a
 *              valley
 *   delta      of a triangle and a side: a theta + phi in its first triangle, a' theta - phi in its second,
 *              where a + a' is 1 (times `hold`) and phi the offset
 *   M          of a triangle: H delta, with the symmetric H of bend_prepare.c
 *   m          of a side: a M + a' M', the moment along it
 *   phi        -= r (M - M'), a step of Jacobi towards equal moments
 *   impulse    of corner i: n times the sum over sides k of m_k g_ki, where g_kk = -1 / h_k and the ends of
 *              a side have what balances it: g_ki = -(e_k . e_i) / (|e_k| |N|), see bend_prepare.c
 *
 * That is the gradient of E = sum of delta H delta / 2, as the angle's gradient at corner i is g_ki n; and
 * phi only ever goes down E. Corners 1 and 2 get their impulses, corner 0 the opposite of both, so the sum is
 * zero to the last bit. theta = 2 asin(s) of s = |n - n'| / 2 is exact for small angles; it is a polynomial,
 * 4e-4 off up to 120 degrees. Impulses are Q26, as in membrane_force.c. */
#include "rt/membrane/membrane.h"
#include "rt/simd/simd.h"

static vec3 edge_vector(const elastic_position *place, uint32_t from, uint32_t to) {
  return vec_clamp_rare(vec_wrap_sub(vec_of(place[to].at), vec_of(place[from].at)), BEND_REACH);
}

static void find_normal(const bend_view *view, uint32_t t) {
  const index_t *v = view->triangle[t].v;
  const vec3 normal =
      vec_cross_q28(edge_vector(view->place, v[0], v[1]), edge_vector(view->place, v[0], v[2]));
  bend_normal *n = &view->normal[t];
  n->valid = vec_squared(normal) >= BEND_FLAT;
  vec_store(n->n, n->valid != 0 ? vec_direction_of(normal).unit : vec_make(0, 0, 0));
}

/* 2 asin(s), Q28, of s = |n1 - n2| / 2, Q30. */
static int32_t angle_of(vec3 n1, vec3 n2) {
  const uint64_t squared = vec_squared(vec_asr(vec_wrap_sub(n1, n2), 1));
  if (squared == 0) return 0;
  const int32_t s = (int32_t)fx_root_length(fx_rsqrt(squared, FX_ROOT_FINE));
  const int32_t x = fx_mul_round(s, s, 30);
  int32_t sum = BEND_ASIN_4;
  sum = BEND_ASIN_3 + fx_mul_round(sum, x, 30);
  sum = BEND_ASIN_2 + fx_mul_round(sum, x, 30);
  sum = BEND_ASIN_1 + fx_mul_round(sum, x, 30);
  sum = BEND_ASIN_0 + fx_mul_round(sum, x, 30);
  return fx_mul_round(s, sum, 30);
}

static void fold(const bend_view *view, uint32_t n) {
  const uint32_t first = (uint32_t)bend_fold(view, FOLD_FIRST)[n];
  const uint32_t second = (uint32_t)bend_fold(view, FOLD_SECOND)[n];
  const bend_normal *n1 = &view->normal[first / 4u];
  const bend_normal *n2 = &view->normal[second / 4u];
  const vec3 up = edge_vector(view->place, (uint32_t)bend_fold(view, FOLD_BASE)[n],
                              (uint32_t)bend_fold(view, FOLD_OPPOSITE)[n]);
  const int32_t size = (n1->valid & n2->valid) != 0 ? angle_of(vec_of(n1->n), vec_of(n2->n)) : 0;
  const int32_t angle = vec_dot_unit(up, vec_of(n1->n)) > 0 ? size : -size;
  const int32_t held = fx_mul_round(angle, bend_fold(view, FOLD_HOLD)[n], 30);
  const int32_t part =
      fx_mul_round(held, bend_fold(view, FOLD_SHARE)[n], 30) + bend_fold(view, FOLD_OFFSET)[n];
  view->moment[first / 4u].side[first % 4u] = part;
  view->moment[second / 4u].side[second % 4u] = held - part;
}

static int32_t moment_of(int32_t h0, int32_t h1, int32_t h2, const int32_t angle[3]) {
  return (int32_t)fx_round64(
      fx_mul_wide(h0, angle[0]) + fx_mul_wide(h1, angle[1]) + fx_mul_wide(h2, angle[2]), 30);
}

static void find_moments(const bend_view *view, uint32_t t) {
  int32_t *m = view->moment[t].side;
  const int32_t angle[3] = {m[0], m[1], m[2]};
  const int32_t h01 = bend_plate(view, PLATE_H01)[t];
  const int32_t h02 = bend_plate(view, PLATE_H02)[t];
  const int32_t h12 = bend_plate(view, PLATE_H12)[t];
  m[0] = moment_of(bend_plate(view, PLATE_H00)[t], h01, h02, angle);
  m[1] = moment_of(h01, bend_plate(view, PLATE_H11)[t], h12, angle);
  m[2] = moment_of(h02, h12, bend_plate(view, PLATE_H22)[t], angle);
}

static void join_moments(const bend_view *view, uint32_t n) {
  const uint32_t first = (uint32_t)bend_fold(view, FOLD_FIRST)[n];
  const uint32_t second = (uint32_t)bend_fold(view, FOLD_SECOND)[n];
  int32_t *const m1 = &view->moment[first / 4u].side[first % 4u];
  int32_t *const m2 = &view->moment[second / 4u].side[second % 4u];
  const int32_t apart = *m1 - *m2;
  const int32_t shared = *m2 + fx_mul_round(apart, bend_fold(view, FOLD_SHARE)[n], 30);
  *m1 = *m2 = fx_mul_round(shared, bend_fold(view, FOLD_HOLD)[n], 30);
  if (view->is_measure != 0) return;
  int32_t *const offset = &bend_fold(view, FOLD_OFFSET)[n];
  const int64_t back = fx_round64(fx_mul_wide(apart, bend_fold(view, FOLD_RATE)[n]), FOLD_RATE_BITS);
  *offset = fx_clamp_wide(*offset - back, BEND_OFFSET_MAX);
}

/* Along the normal. */
static int32_t corner_impulse(const bend_view *view, const int32_t m[3], int32_t g0, int32_t g1, int32_t g2) {
  const int64_t sum = fx_mul_wide(m[0], g0) + fx_mul_wide(m[1], g1) + fx_mul_wide(m[2], g2);
  return fx_clamp_wide(fx_round64(sum, view->impulse_shift), BEND_MAX);
}

static void push_corners(const bend_view *view, uint32_t t) {
  const index_t *v = view->triangle[t].v;
  const int32_t *m = view->moment[t].side;
  const vec3 normal = vec_of(view->normal[t].n);
  const vec3 one =
      vec_scale_unit(normal, corner_impulse(view, m, bend_plate(view, PLATE_G01)[t],
                                            bend_plate(view, PLATE_G11)[t], bend_plate(view, PLATE_G21)[t]));
  const vec3 two =
      vec_scale_unit(normal, corner_impulse(view, m, bend_plate(view, PLATE_G02)[t],
                                            bend_plate(view, PLATE_G12)[t], bend_plate(view, PLATE_G22)[t]));
  elastic_impulse_add(&view->sum[v[0]], vec_negated(vec_add(one, two)));
  elastic_impulse_add(&view->sum[v[1]], one);
  elastic_impulse_add(&view->sum[v[2]], two);
}

static bend_view view_of(const fray_world *w, int is_measure) {
  const bend_view view = {w->membrane.positions,
                          w->membrane.impulse,
                          w->trimesh.triangle,
                          w->membrane.plates,
                          w->membrane.folds,
                          w->membrane.normals,
                          w->membrane.moments,
                          w->capacity[POOL_TRIANGLES],
                          bend_fold_stride(w),
                          (unsigned)w->membrane.constants->bend_bits - BEND_IMPULSE_LESS,
                          is_measure};
  return view;
}

static void find_angles(const fray_world *w, const bend_view *view) {
  const uint32_t triangles = triangles_in_use(w);
  const uint32_t folds = w->membrane.fold_count;
  uint32_t t = 0;
  uint32_t n = 0;
  FRAY_ASSERT(2u * folds <= 3u * triangles);
  while (t < triangles) {
    t += simd_bend_normals(w->kernel, view, t, triangles);
    if (t < triangles) find_normal(view, t++);
  }
  while (n < folds) {
    n += simd_bend_folds(w->kernel, view, n, folds);
    if (n < folds) fold(view, n++);
  }
}

void bend_force_add(fray_world *w, bend_step_kind kind) {
  const bend_view view = view_of(w, kind == BEND_MEASURED);
  const uint32_t triangles = triangles_in_use(w);
  const uint32_t folds = w->membrane.fold_count;
  uint32_t n = 0;
  find_angles(w, &view);
  if (kind == BEND_LAST) bend_habit_update(w);
  for (uint32_t t = 0; t < triangles;) {
    t += simd_bend_moments(w->kernel, &view, t, triangles);
    if (t < triangles) find_moments(&view, t++);
  }
  while (n < folds) {
    n += simd_bend_joints(w->kernel, &view, n, folds);
    if (n < folds) join_moments(&view, n++);
  }
  for (uint32_t t = 0; t < triangles;) {
    t += simd_bend_corners(w->kernel, &view, t, triangles);
    if (t < triangles) push_corners(&view, t++);
  }
  if (kind == BEND_LAST) bend_offsets_store(w);
  w->work.bend_forces += folds;
}

#if FRAY_ENERGY
void bend_angles_find(fray_world *w) {
  const bend_view view = view_of(w, 1);
  find_angles(w, &view);
}
#endif
