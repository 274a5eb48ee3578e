/* SPDX-License-Identifier: Apache-2.0 */
/* Bending forces of a plate of triangles (Morley 1968; Hellan, Herrmann, Johnson), in every elastic step or
 * every few. SIMD twin: rt/simd/bend_force_lanes.inl.h.
 *
 *   theta      of a side: the angle between the normals n of its triangles, above 0 where these form a
 *              valley
 *   delta      of a triangle and a side: a theta + phi in its first triangle, a' theta - phi in its second,
 *              where a + a' is 1 (times `hold`) and phi the offset
 *   M          of a triangle: H delta, with the symmetric H of bend_stiffness.c
 *   m          of a side: a M + a' M', the moment along it
 *   phi        -= r (M - M'), a step of Jacobi towards equal moments
 *   torque     R of a triangle: the sum over its sides of m_k e_k / |e_k|
 *   impulse    of corner i: -n (e_i . R) / |N|
 *
 * That is the gradient of E = sum of delta H delta / 2, as that of an angle at corner i is -n (e_k . e_i) /
 * (|e_k| |N|), where the triangle is now; but for |e_k|, which is of the tick's beginning. And phi only ever
 * goes down E. Corners 1 and 2 get their impulses, corner 0 the opposite of both, so the sum is zero to the
 * last bit. theta = 2 asin(s) of s = |n - n'| / 2 is exact for small angles; it is a polynomial,
 * 4e-4 off up to 120 degrees. Impulses are Q26, as in membrane_force.c. */
#include "rt/membrane/membrane.h"
#include "rt/simd/simd.h"

/* Returns whether |N| is below what bend_prepare() left. */
static int find_normal(const bend_view *view, uint32_t t) {
  const index_t *v = view->triangle[t].v;
  const vec3 normal =
      vec_cross_q28(bend_edge(view->place, v[0], v[1]), bend_edge(view->place, v[0], v[2]));
  const uint64_t squared = vec_squared(normal);
  const uint64_t least = (uint64_t)(uint32_t)bend_plate(view, PLATE_AREA_MIN)[t] << BEND_AREA_DOWN;
  bend_normal *n = &view->normal[t];
  if (squared < BEND_FLAT) {
    vec_store(n->n, vec_make(0, 0, 0));
    n->per_area = 0;
    return 1;
  }
  const fx_root root = fx_rsqrt(squared, FX_ROOT_FINE);
  vec_store(n->n, vec_root_unit(root, normal));
  n->per_area = bend_per_area_of(root);
  return squared < least;
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
  const vec3 up = bend_edge(view->place, (uint32_t)bend_fold(view, FOLD_BASE)[n],
                              (uint32_t)bend_fold(view, FOLD_OPPOSITE)[n]);
  const int32_t size = n1->per_area != 0 && n2->per_area != 0 ? angle_of(vec_of(n1->n), vec_of(n2->n)) : 0;
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

/* R, Q(bend_bits - 4). */
static vec3 torque_of(const bend_view *view, uint32_t t, const vec3 e[3]) {
  const int32_t *m = view->moment[t].side;
  vec64 sum = {0, 0, 0};
  for (uint32_t k = 0; k < 3; ++k) {
    const int32_t per_length =
        fx_clamp_wide(fx_round64(fx_mul_wide(m[k], bend_plate(view, PLATE_PER_LENGTH_0 + k)[t]),
                                 BEND_PER_LENGTH_LESS),
                      BEND_TORQUE_MAX);
    sum = vec_add64(sum, vec_scale64(e[k], per_length));
  }
  return vec_round_clamped(sum, BEND_TORQUE_LESS, BEND_TORQUE_MAX);
}

/* Along the normal, of the corner opposite e. */
static int32_t corner_impulse(const bend_view *view, uint32_t t, vec3 e, vec3 torque) {
  const int32_t per_area = view->normal[t].per_area;
  const int32_t along = fx_saturate(fx_round64(vec_dot64(e, torque), 28));
  const int32_t shift = (per_area & BEND_EXPONENT) + view->impulse_shift;
  const int64_t product = fx_mul_wide(along, per_area & ~BEND_EXPONENT);
  return -fx_clamp_wide(fx_round64(product, (unsigned)fx_clamp(shift, 1, 62)), BEND_MAX);
}

static void push_corners(const bend_view *view, uint32_t t) {
  const index_t *v = view->triangle[t].v;
  const vec3 normal = vec_of(view->normal[t].n);
  const vec3 e2 = bend_edge(view->place, v[0], v[1]);
  const vec3 d2 = bend_edge(view->place, v[0], v[2]);
  const vec3 e[3] = {vec_sub(d2, e2), vec_negated(d2), e2};
  const vec3 torque = torque_of(view, t, e);
  const vec3 one = vec_scale_unit(normal, corner_impulse(view, t, e[1], torque));
  const vec3 two = vec_scale_unit(normal, corner_impulse(view, t, e[2], torque));
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
                          w->membrane.constants->bend_bits - BEND_IMPULSE_LESS,
                          is_measure};
  return view;
}

static void find_angles(fray_world *w, const bend_view *view) {
  const uint32_t triangles = triangles_in_use(w);
  const uint32_t folds = w->membrane.fold_count;
  uint32_t t = 0;
  uint32_t n = 0;
  int pressed = 0;
  FRAY_ASSERT(2u * folds <= 3u * triangles);
  while (t < triangles) {
    t += simd_bend_normals(w->kernel, view, t, triangles);
    if (t < triangles && find_normal(view, t++) && view->is_measure == 0) {
      bend_press(w, t - 1u);
      pressed = 1;
    }
  }
  if (pressed) bend_folds_hold(w);
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
  if (kind == BEND_LAST) bend_follow(w);
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

void bend_angles_find(fray_world *w) {
  const bend_view view = view_of(w, 1);
  find_angles(w, &view);
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
