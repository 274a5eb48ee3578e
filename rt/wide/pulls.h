/* SPDX-License-Identifier: Apache-2.0 */
/* The stress of triangles, LANES at a time: stage/pull.c says what is computed, in the same order. What
 * would have to be held to a bound is left to the scalar code. */
#ifndef FRAY_WIDE_PULLS_H
#define FRAY_WIDE_PULLS_H

#include "rt/wide/inner.h"
#include "rt/wide/longs.h"
#include "rt/wide/pairs.h"
#include "rt/wide/records.h"

#ifdef LANES_LONGS
enum { PULLS_AXIS = 54, PULLS_STRESS = 58, PULLS_CORNER = 56 }; /* bits of sums before they are rounded */

/* Of some triangles. */
typedef struct {
  uint32_t id[3][LANES];
  lanes u[3], v[3]; /* axes, Q28 */
  lanes r[4];       /* u1, u2, v1, v2 */
  lanes uu, vv, uv; /* impulse of stress */
  longs far_axis, far_stress, far_corner;
} pulls;

/* Ways along the axes. */
LANES_INLINE void pulls_way(const lanes from[4], const lanes to[4], lanes way[3]) {
  /* bytes that do not borrow from one another */
  const lanes below = lanes_sub(lanes_add(to[3], lanes_all(0x040404)), from[3]);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    const lanes whole = lanes_clamp(lanes_sub(to[n], from[n]), INNER_WAY_REACH);
    const lanes more = lanes_and(n == 0 ? below : lanes_asr(below, 8u * (unsigned)n), lanes_all(7));
    way[n] = lanes_add(lanes_shl(whole, INNER_WAY_MORE), lanes_sub(more, lanes_all(4)));
  }
}

LANES_INLINE lanes pulls_sum(longs *far, lanes a, lanes b, lanes c, lanes d, unsigned bits) {
  const longs sum = longs_add(longs_mul(a, b), longs_mul(c, d));
  *far = longs_farther(*far, sum);
  return longs_round(sum, bits);
}

LANES_INLINE void pulls_fetch(const pull_view *v, uint32_t first, uint32_t count, pulls *s, lanes c[4]) {
  uint32_t of[LANES];
  lanes at[3][4], d1[3], d2[3];
  for (uint32_t n = 0; n < (uint32_t)LANES; ++n) {
    of[n] = first + (n < count ? n : 0);
    for (uint32_t k = 0; k < 3; ++k) s->id[k][n] = v->triangle[of[n]].v[k];
  }
  LONGS_UNROLLED
  for (int k = 0; k < 3; ++k) records_take(v->place->at, 4, s->id[k], at[k]);
  records_take(&v->weights->u1, 4, of, s->r);
  records_take(v->row->c, 4, of, c);
  pulls_way(at[0], at[1], d1);
  pulls_way(at[0], at[2], d2);
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    const unsigned bits = SHEET_WEIGHT_BITS + FX_VELOCITY_BITS + INNER_WAY_MORE - STRAIN_BITS;
    s->u[n] = pulls_sum(&s->far_axis, d1[n], s->r[0], d2[n], s->r[1], bits);
    s->v[n] = pulls_sum(&s->far_axis, d1[n], s->r[2], d2[n], s->r[3], bits);
  }
}

LANES_INLINE longs pulls_dot(const lanes a[3], const lanes b[3]) {
  return longs_add(longs_add(longs_mul(a[0], b[0]), longs_mul(a[1], b[1])), longs_mul(a[2], b[2]));
}

LANES_INLINE void pulls_stress(pulls *s, const lanes c[4]) {
  const longs one = longs_all((int64_t)1 << 2 * STRAIN_BITS);
  const longs uu = longs_sub(pulls_dot(s->u, s->u), one);
  const longs vv = longs_sub(pulls_dot(s->v, s->v), one);
  const longs uv = pulls_dot(s->u, s->v);
  s->far_stress = longs_farther(longs_farther(longs_farther(s->far_stress, uu), vv), uv);
  const lanes g_uu = longs_round(uu, STRAIN_BITS + 1);
  const lanes g_vv = longs_round(vv, STRAIN_BITS + 1);
  const lanes g_uv = longs_round(uv, STRAIN_BITS);
  const longs shear = longs_mul(c[3], g_uv);
  s->uu = pulls_sum(&s->far_stress, c[0], g_uu, c[1], g_vv, STRAIN_BITS);
  s->vv = pulls_sum(&s->far_stress, c[1], g_uu, c[2], g_vv, STRAIN_BITS);
  s->far_stress = longs_farther(s->far_stress, shear);
  s->uv = longs_round(shear, STRAIN_BITS);
}

LANES_INLINE void pulls_give(const pull_view *v, pulls *s, lanes one[4], lanes two[4]) {
  const unsigned bits = SHEET_WEIGHT_BITS + PULL_MORE_BITS;
  (void)v;
  LONGS_UNROLLED
  for (int n = 0; n < 3; ++n) {
    const lanes p1 = pulls_sum(&s->far_stress, s->uu, s->u[n], s->uv, s->v[n], STRAIN_BITS);
    const lanes p2 = pulls_sum(&s->far_stress, s->uv, s->u[n], s->vv, s->v[n], STRAIN_BITS);
    one[n] = lanes_clamp(pulls_sum(&s->far_corner, p1, s->r[0], p2, s->r[2], bits), PULL_MAX);
    two[n] = lanes_clamp(pulls_sum(&s->far_corner, p1, s->r[1], p2, s->r[3], bits), PULL_MAX);
  }
  one[3] = two[3] = lanes_all(0);
}

LANES_INLINE int pulls_group(const pull_view *v, uint32_t first, uint32_t count) {
  pulls s;
  lanes c[4], one[4], two[4], both[4];
  s.far_axis = s.far_stress = s.far_corner = longs_all(0);
  pulls_fetch(v, first, count, &s, c);
  pulls_stress(&s, c);
  pulls_give(v, &s, one, two);
  if (longs_any_from(s.far_axis, PULLS_AXIS) || longs_any_from(s.far_stress, PULLS_STRESS) ||
      longs_any_from(s.far_corner, PULLS_CORNER))
    return 0;
  LONGS_UNROLLED
  for (int n = 0; n < 4; ++n) {
    both[n] = lanes_add(one[n], two[n]);
    one[n] = lanes_sub(lanes_all(0), one[n]);
    two[n] = lanes_sub(lanes_all(0), two[n]);
  }
  records_add(&v->sum->x, s.id[0], count, both);
  records_add(&v->sum->x, s.id[1], count, one);
  records_add(&v->sum->x, s.id[2], count, two);
  return 1;
}

RECORDS_GROUPS(pulls_run, pull_view, pulls_group)
#endif

#endif
