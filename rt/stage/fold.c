/* SPDX-License-Identifier: Apache-2.0 */
/* Two triangles with a side in common resist being folded there (Bridson, Marino, Fedkiw 2003;
 * Karaoz 2015, 2.49 to 2.58):
 *
 *   F_i = k |E|^2 / (|N1| + |N2|) sin(t/2) u_i
 *
 * with u_4 = -(...): 2.55 as printed lacks the minus, and the four would not sum to zero. Vertices
 * 1 and 2 are opposite the side, 3 and 4 its ends. With heights h and n the unit normals
 *
 *   u1 = n1 / h1, u2 = n2 / h2, u3 = f1 u1 + f2 u2, f = (x - x4).E / |E|^2, u4 = -(u1 + u2 + u3)
 *
 * What strains alone change, stage/crease.c works out once a tick; here are the normals and the angle.
 * Impulses are those of pull.c. */
#include "rt/stage/hinge.h"
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

static int32_t along(const inner_place *from, const inner_place *to, uint32_t axis) {
  return fx_clamp_rare(fx_wrap_sub(to->at[axis], from->at[axis]), -HINGE_REACH, HINGE_REACH);
}
static vec3 way(const inner_place *place, uint32_t from, uint32_t to) {
  return vec_make(along(&place[from], &place[to], 0), along(&place[from], &place[to], 1),
                  along(&place[from], &place[to], 2));
}

static void give(inner_sum *sum, vec3 j) {
  sum->x = fx_add(sum->x, j.x);
  sum->y = fx_add(sum->y, j.y);
  sum->z = fx_add(sum->z, j.z);
}

/* Impulse of a vertex opposite the side: along its normal, against the fold. */
static vec3 opposite(int32_t turning, int32_t height, vec3 normal) {
  const int64_t size = fx_round64(fx_mul_wide(turning, height), 24);
  return vec_scale_unit(normal, (int32_t)fx_clamp64(size, -FOLD_MAX, FOLD_MAX));
}

static vec3 of(vec3 j, int32_t share_q24) {
  return vec_make((int32_t)fx_round64(fx_mul_wide(j.x, share_q24), 24),
                  (int32_t)fx_round64(fx_mul_wide(j.y, share_q24), 24),
                  (int32_t)fx_round64(fx_mul_wide(j.z, share_q24), 24));
}

/* By the curvature of the moment, linear between those of the table, which holds beyond its last. */
static int32_t stiffness(const crease *c, int32_t half) {
  const uint32_t last = FABRIC_CURVES - 1;
  const int64_t place = fx_asr64(fx_mul_wide(half, c->reach), 28); /* Q24 */
  if (place >> 24 >= last) return c->stiff[last];
  const uint32_t step = (uint32_t)(place >> 24);
  const int32_t more = fx_sub(c->stiff[step + 1u], c->stiff[step]);
  return c->stiff[step] + (int32_t)fx_round64(fx_mul_wide(more, (int32_t)(place & 0xFFFFFF)), 24);
}

static void fold(const fold_view *view, const crease *c) {
  const hinge h = hinge_of(way(view->place, c->x[2], c->x[3]), way(view->place, c->x[3], c->x[0]),
                           way(view->place, c->x[3], c->x[1]));
  if (!hinge_is_sound(&h)) return;
  const vec3 n1 = hinge_unit_of(h.area1).along;
  const vec3 n2 = hinge_unit_of(h.area2).along;
  const int32_t half = hinge_half(n1, n2);
  const int32_t size = (int32_t)fx_round64(fx_mul_wide(stiffness(c, half), half), 30);
  const int32_t turning = vec_dot_unit(h.to2, n1) > 0 ? -size : size;
  const vec3 j1 = opposite(turning, c->height[0], n1);
  const vec3 j2 = opposite(turning, c->height[1], n2);
  const vec3 j3 = vec_add(of(j1, c->foot[0]), of(j2, c->foot[1]));
  const vec3 back = vec_add(vec_add(j1, j2), j3);
  give(&view->sum[c->x[0]], j1);
  give(&view->sum[c->x[1]], j2);
  give(&view->sum[c->x[2]], j3);
  give(&view->sum[c->x[3]], vec_make(-back.x, -back.y, -back.z));
}

void fold_sides(fray_world *w) {
  const fold_view view = {w->places, w->sums, w->creases};
  uint32_t n = 0;
  while (n < w->crease_count) {
    n += wide_fold(w->kernel, &view, n, w->crease_count);
    if (n < w->crease_count) fold(&view, &w->creases[n++]);
  }
  w->work.folds += w->crease_count;
}
