/* SPDX-License-Identifier: Apache-2.0 */
/* Two triangles with a side in common resist being folded there (Bridson, Marino, Fedkiw 2003;
 * Karaoz 2015, 2.49 to 2.58):
 *
 *   F_i = k |E|^2 / (|N1| + |N2|) sin(t/2) u_i
 *
 * with u_4 = -(...): 2.55 as printed lacks the minus, and the four would not sum to zero. Vertices
 * 1 and 2 are opposite the side, 3 and 4 its ends. With heights h = |N| / |E| and n the unit
 * normals
 *
 *   u1 = n1 / h1, u2 = n2 / h2, u3 = f1 u1 + f2 u2, f = (x - x4).E / |E|^2, u4 = -(u1 + u2 + u3)
 *
 * and 2 sin(t/2) = |n1 - n2|, which is exact for small angles, where 2.57 is not.
 *
 * k = 24/5 D: then a strip that bends along the regular mesh has the measured stiffness D. With all
 * sides of the same curvature that is 4 D; but vertices where four triangles meet give way by 1/12
 * of a cell's sag against those where eight do, which takes 1/6 of the energy away. D goes by the
 * direction of the side at rest against the weft, and by the curvature 2 |n1 - n2| / (h1 + h2).
 *
 * Impulses are those of pull.c: 24/5 D sin(t/2) |E|^2 / (|N1| + |N2|) / h times
 * every h^2 / (i m lu^2) 2^34, which is bend_gain for D in 2^-40 N m; 8 bits are taken off at the
 * end. */
#include "rt/model/element.h"
#include "rt/stage/stage.h"

enum { FOLD_MAX = 1 << 20, FOLD_REACH = FX_LU * 16 /* Q28: corners farther apart count as a lu */ };

/* Q28 of n / d, for d above 0. */
static int32_t ratio(int64_t n, uint32_t d, unsigned bits) {
  const uint64_t magnitude = (uint64_t)(n < 0 ? -n : n);
  const uint32_t quotient = fx_divide_wide(magnitude << bits, d);
  const int32_t bounded = quotient > INT32_MAX ? INT32_MAX : (int32_t)quotient;
  return n < 0 ? -bounded : bounded;
}

static vec3 way(const fray_world *w, uint32_t from, uint32_t to) {
  return vec_make(fx_clamp_rare(fx_wrap_sub(w->qx[to], w->qx[from]), -FOLD_REACH, FOLD_REACH),
                  fx_clamp_rare(fx_wrap_sub(w->qy[to], w->qy[from]), -FOLD_REACH, FOLD_REACH),
                  fx_clamp_rare(fx_wrap_sub(w->qz[to], w->qz[from]), -FOLD_REACH, FOLD_REACH));
}

/* Q28 of Q28; ways are at most a lu along each axis. */
static vec3 cross(vec3 a, vec3 b) {
  return vec_make((int32_t)fx_round64(fx_mul_wide(a.y, b.z) - fx_mul_wide(a.z, b.y), 28),
                  (int32_t)fx_round64(fx_mul_wide(a.z, b.x) - fx_mul_wide(a.x, b.z), 28),
                  (int32_t)fx_round64(fx_mul_wide(a.x, b.y) - fx_mul_wide(a.y, b.x), 28));
}
static int64_t dot(vec3 a, vec3 b) {
  return fx_round64(fx_mul_wide(a.x, b.x) + fx_mul_wide(a.y, b.y) + fx_mul_wide(a.z, b.z), 28);
}
static vec3 fold_unit(vec3 v, uint32_t *length) {
  const fx_root root = fx_rsqrt(vec_squared(v), FX_ROOT_FINE);
  *length = fx_root_length(root);
  return vec_make(fx_root_unit(root, v.x), fx_root_unit(root, v.y), fx_root_unit(root, v.z));
}

/* By the direction of a side at rest, Q28 of 0..2 for 0, 45, 90 degrees, and a curvature, Q24 of
 * the table's steps. 2^-40 N m. */
static int32_t stiffness(const fabric *f, int32_t direction, uint32_t curvature) {
  const uint32_t row = direction >= STRAIN_ONE ? 1 : 0;
  const int32_t turned = direction - (int32_t)(row << STRAIN_BITS);
  const uint32_t last = FABRIC_CURVES - 1;
  const uint32_t at = curvature >> 24 < last ? curvature >> 24 : last - 1u;
  const int32_t bent = curvature >> 24 < last ? (int32_t)(curvature & 0xFFFFFFu) : 1 << 24;
  int32_t found[2];
  for (uint32_t n = 0; n < 2; ++n) {
    const int32_t *k = f->bend[row + n];
    found[n] = k[at] + (int32_t)fx_round64(fx_mul_wide(fx_sub(k[at + 1u], k[at]), bent), 24);
  }
  return found[0] +
         (int32_t)fx_round64(fx_mul_wide(fx_sub(found[1], found[0]), turned), STRAIN_BITS);
}

/* 2 (cos, sin) of twice the angle are (u^2 - v^2, 2 u v): mirrored into 0 to 90 degrees. */
static int32_t direction_of(const sheet_mesh *s, uint32_t from, uint32_t to) {
  const int64_t u = fx_asr(fx_sub(s->u[to], s->u[from]), 8);
  const int64_t v = fx_asr(fx_sub(s->v[to], s->v[from]), 8);
  const int64_t x = u * u - v * v;
  const int64_t y = 2 * u * v;
  const int32_t cosine = fx_saturate(fx_round64(x, 6));
  const int32_t sine = fx_saturate(fx_round64(y < 0 ? -y : y, 6));
  if (cosine == 0 && sine == 0) return 0;
  return fabric_direction(cosine / 2, sine / 2) / 2;
}

static void give(fray_world *w, uint32_t p, vec3 j) {
  w->sum_x[p] = fx_add(w->sum_x[p], j.x);
  w->sum_y[p] = fx_add(w->sum_y[p], j.y);
  w->sum_z[p] = fx_add(w->sum_z[p], j.z);
}

/* Impulse of a vertex opposite the side: along its normal, against the fold. */
static vec3 opposite(int64_t turning, uint32_t edge, uint32_t twice_area, vec3 normal) {
  const int32_t inverse = ratio(edge, twice_area, 16);
  const int64_t size = fx_round64(fx_mul_wide(fx_saturate(turning), inverse), 24);
  return vec_scale_unit(normal, (int32_t)fx_clamp64(size, -FOLD_MAX, FOLD_MAX));
}

static vec3 of(vec3 j, int32_t share_q24) {
  return vec_make((int32_t)fx_round64(fx_mul_wide(j.x, share_q24), 24),
                  (int32_t)fx_round64(fx_mul_wide(j.y, share_q24), 24),
                  (int32_t)fx_round64(fx_mul_wide(j.z, share_q24), 24));
}

static int32_t fold_foot(vec3 from_end, vec3 e, uint32_t squared) {
  return fx_clamp(ratio(dot(from_end, e), squared, 24), -2 * (1 << 24), 2 * (1 << 24));
}

static void fold_side(fray_world *w, uint32_t t, uint32_t k) {
  const sheet_mesh *s = &w->sheet;
  const uint32_t other = s->triangle[t].across[k];
  const uint32_t x1 = s->triangle[t].v[k];
  const uint32_t x3 = s->triangle[t].v[sheet_last(k)];
  const uint32_t x4 = s->triangle[t].v[sheet_next(k)];
  const uint32_t x2 = s->triangle[other].v[sheet_back(s, t, k)];
  const vec3 e = way(w, x3, x4);
  const vec3 d1 = way(w, x4, x1);
  const vec3 d2 = way(w, x4, x2);
  const vec3 across1 = cross(e, d1); /* (x1 - x3) x (x1 - x4) */
  const vec3 across2 = cross(d2, e);
  uint32_t area1;
  uint32_t area2;
  if (vec_squared(across1) < 1u << 16 || vec_squared(across2) < 1u << 16 ||
      vec_squared(e) < 1u << 16)
    return;
  const vec3 n1 = fold_unit(across1, &area1);
  const vec3 n2 = fold_unit(across2, &area2);
  const vec3 off = vec_make(fx_asr(fx_wrap_sub(n1.x, n2.x), 1), fx_asr(fx_wrap_sub(n1.y, n2.y), 1),
                            fx_asr(fx_wrap_sub(n1.z, n2.z), 1));
  if (vec_squared(off) == 0) return;
  const uint32_t half =
      fx_root_length(fx_rsqrt(vec_squared(off), FX_ROOT_FINE));                 /* sin(t/2), Q30 */
  const uint32_t edge = fx_root_length(fx_rsqrt(vec_squared(e), FX_ROOT_FINE)); /* Q28 */
  const uint32_t squared = (uint32_t)fx_round64((int64_t)vec_squared(e), 28);
  const uint32_t areas = area1 + area2;
  /* 1 / lu, Q24: 2 |n1 - n2| |E| / (|N1| + |N2|) = 4 half edge / areas */
  const int32_t bent = ratio(fx_round64(fx_mul_wide((int32_t)half, (int32_t)edge), 28), areas, 24);
  const uint64_t place = (uint64_t)(uint32_t)bent * (uint32_t)w->cloths->curve_gain >> 24;
  const int32_t stiff = stiffness(&w->fabrics[s->cloth[t]], direction_of(s, x3, x4),
                                  place > UINT32_MAX ? UINT32_MAX : (uint32_t)place);
  const int64_t shape = fx_round64(fx_mul_wide(stiff, ratio(squared, areas, 24)), 24);
  const int64_t turned = fx_round64(fx_mul_wide(fx_saturate(shape), (int32_t)half), 30);
  const int64_t size = fx_round64(fx_mul_wide(fx_saturate(turned), w->cloths->bend_gain),
                                  (unsigned)w->cloths->bend_shift);
  const int64_t turning = vec_dot_unit(d2, n1) > 0 ? -size : size;
  const vec3 j1 = opposite(turning, edge, area1, n1);
  const vec3 j2 = opposite(turning, edge, area2, n2);
  const vec3 j3 = vec_add(of(j1, fold_foot(d1, e, squared)), of(j2, fold_foot(d2, e, squared)));
  const vec3 back = vec_add(vec_add(j1, j2), j3);
  give(w, x1, j1);
  give(w, x2, j2);
  give(w, x3, j3);
  give(w, x4, vec_make(-back.x, -back.y, -back.z));
}

void fold_sides(fray_world *w) {
  const sheet_mesh *s = &w->sheet;
  uint32_t folds = 0;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t)
    for (uint32_t k = 0; k < 3; ++k)
      if (s->triangle[t].across[k] > t) {
        fold_side(w, t, k);
        ++folds;
      }
  w->work.folds += folds;
}
