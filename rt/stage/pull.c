/* SPDX-License-Identifier: Apache-2.0 */
/* The stress of triangles moves their vertices (Karaoz 2015, 2.32), explicitly, in inner steps: see
 * stage/inner.c.
 *
 * Force on corner j, with the area A of a triangle, is -A (r_uj (s_uu U + s_uv V) + r_vj (s_vv V + s_uv U)).
 * Impulses are in masses of a particle times Q26 lu per substep. With the stress in N/m, A in lu^2, a
 * weight r in 1/lu, a substep of h, i inner steps and a particle of m
 *
 *   impulse = A r s U h^2 / (i m) 2^26:   gain(A, c) = A c h^2 / (i m) 2^30, so stress has four bits more
 *
 * is worked out once a tick, with c by what the strain has been (fabric.h, habit). Strain times gain is
 * held to 2^31.
 * Corners 1 and 2 get theirs, corner 0 the opposite of both, so the sum is zero to the last bit. An
 * impulse of a corner is held to 2^26 - 2^22: those of 16 triangles fit 32 bits, with as much as a fold and
 * the wind may add. */
#include "rt/model/element.h"
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

enum { LEFT = 751619277 /* 7/10 in Q30 */ };

static void weigh_vertices(fray_world *w) {
  const uint64_t unit = (uint64_t)(uint32_t)w->cloths->unit << INNER_INVERSE_BITS;
  for (uint32_t p = 0; p < w->particles; ++p) {
    const uint32_t inverse = fx_divide_wide(unit, w->sheet.mass[p]);
    w->inverse[p] = inverse > INT32_MAX ? INT32_MAX : (int32_t)inverse;
  }
}

/* A triangle that a tear or a cut left lower than inner steps of this length can bear is softer. The square
 * of a weight's length is that of 1 / height. A right triangle vibrates at most by 1.6 of the largest, a
 * flat one by 2 of it, and with no neighbour that holds it back: 7/10 of what could be borne is left. Q30. */
static int32_t left_of(const fray_world *w, uint32_t t) {
  const sheet_weights *r = &w->sheet.weights[t];
  const uint64_t ends[3] = {fx_square(r->u1) + fx_square(r->v1), fx_square(r->u2) + fx_square(r->v2),
                            fx_square(fx_add(r->u1, r->u2)) + fx_square(fx_add(r->v1, r->v2))};
  const uint64_t more = ends[0] > ends[1] ? ends[0] : ends[1];
  const uint64_t most = (more > ends[2] ? more : ends[2]) >> 32; /* Q12 */
  const uint32_t steep = (uint32_t)w->cloths->steep;
  return most <= steep ? 1 << 30 : (int32_t)fx_divide_wide((uint64_t)steep * LEFT, (uint32_t)most);
}

static void settle(tensor *mean, tensor to, unsigned shift) {
  mean->uu += (int32_t)fx_round64((int64_t)to.uu - mean->uu, shift);
  mean->vv += (int32_t)fx_round64((int64_t)to.vv - mean->vv, shift);
  mean->uv += (int32_t)fx_round64((int64_t)to.uv - mean->uv, shift);
}

/* Returns what c goes by. */
static tensor get_used_to(habit *h, tensor strain, unsigned shift) {
  if (shift == 0) return strain;
  for (uint32_t n = 0; n < HABIT_POLES; ++n) settle(&h->mean[n], n == 0 ? strain : h->mean[n - 1u], shift);
  return h->mean[HABIT_POLES - 1];
}

static void stress_triangle(const fray_world *w, uint32_t t) {
  const element_axes e = element_axes_of(w, t);
  const tensor strain = fabric_strain(e.u, e.v);
  int32_t *c = w->pull[t].c;
  const int32_t left = left_of(w, t);
  fabric_stiffness(&w->fabrics[w->sheet.cloth[t]],
                   get_used_to(&w->habits[t], strain, (unsigned)w->cloths->habit_shift), c);
  w->stress[t] = fabric_stress(c, strain);
  if (left == 1 << 30) return;
  w->stress[t].uu = (int32_t)fx_round64(fx_mul_wide(w->stress[t].uu, left), 30);
  w->stress[t].vv = (int32_t)fx_round64(fx_mul_wide(w->stress[t].vv, left), 30);
  w->stress[t].uv = (int32_t)fx_round64(fx_mul_wide(w->stress[t].uv, left), 30);
}

void stress_run(fray_world *w) {
  if (!world_has_sheet(w)) return;
  const sheet_mesh *s = &w->sheet;
  const cloth_params *c = w->cloths;
  const stress_view view = {{w->x, w->y, w->z}, s->triangle, s->weights, w->fabrics, s->cloth,
                            (unsigned)c->habit_shift, c->steep, w->habits, w->pull, w->stress};
  const uint32_t count = (uint32_t)s->state->triangles;
  uint32_t t = 0;
  while (t < count) {
    t += wide_stress(w->kernel, &view, t, count);
    if (t < count) stress_triangle(w, t++);
  }
}

/* After tears and cuts, which divide areas and masses: c becomes gains. */
void weigh_run(fray_world *w) {
  if (!world_has_sheet(w)) return;
  const sheet_mesh *s = &w->sheet;
  const unsigned shift = (unsigned)w->cloths->pull_shift;
  weigh_vertices(w);
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    int32_t *c = w->pull[t].c;
    const int32_t area = (int32_t)fx_round64(fx_mul_wide((int32_t)s->area[t], left_of(w, t)), 30);
    const int32_t gain = (int32_t)fx_round64(fx_mul_wide(area, w->cloths->pull_gain), 30);
    for (uint32_t n = 0; n < FABRIC_ENTRIES; ++n)
      c[n] = fx_saturate(fx_round64(fx_mul_wide(c[n], gain), shift));
  }
  creases_weigh(w);
}

static inline int32_t bounded(int64_t q56) { return fx_saturate(fx_round64(q56, STRAIN_BITS)); }

/* P Q30 and r Q22 to the impulse of a corner. */
static inline int32_t corner(int32_t p1, int32_t p2, int32_t r1, int32_t r2) {
  const int64_t sum = fx_mul_wide(p1, r1) + fx_mul_wide(p2, r2);
  return (int32_t)fx_clamp64(fx_round64(sum, SHEET_WEIGHT_BITS + PULL_MORE_BITS), -PULL_MAX, PULL_MAX);
}

/* Of the corners 1 and 2 along one axis. */
typedef struct {
  int32_t one, two;
} corners;
static inline corners give(const sheet_weights *r, int32_t u, int32_t v, const tensor *s) {
  const int32_t p1 = bounded(fx_mul_wide(s->uu, u) + fx_mul_wide(s->uv, v));
  const int32_t p2 = bounded(fx_mul_wide(s->uv, u) + fx_mul_wide(s->vv, v));
  const corners j = {corner(p1, p2, r->u1, r->v1), corner(p1, p2, r->u2, r->v2)};
  return j;
}

static vec3 way(const inner_place *place, uint32_t from, uint32_t to) {
  return vec_make(inner_way(&place[from], &place[to], 0), inner_way(&place[from], &place[to], 1),
                  inner_way(&place[from], &place[to], 2));
}

static void add(inner_sum *sum, int32_t x, int32_t y, int32_t z) {
  sum->x = fx_add(sum->x, x);
  sum->y = fx_add(sum->y, y);
  sum->z = fx_add(sum->z, z);
}

static void pull_triangle(const pull_view *view, uint32_t t) {
  const row_id *of = view->triangle[t].v;
  const sheet_weights *r = &view->weights[t];
  const int32_t *c = view->row[t].c;
  const element_axes e = element_axes_by(way(view->place, of[0], of[1]), way(view->place, of[0], of[2]), r,
                                         FX_VELOCITY_BITS + INNER_WAY_MORE);
  const tensor g = fabric_strain(e.u, e.v);
  const tensor s = {bounded(fx_mul_wide(c[0], g.uu) + fx_mul_wide(c[1], g.vv)),
                    bounded(fx_mul_wide(c[1], g.uu) + fx_mul_wide(c[2], g.vv)),
                    bounded(fx_mul_wide(c[3], g.uv))};
  const corners x = give(r, e.u.x, e.v.x, &s);
  const corners y = give(r, e.u.y, e.v.y, &s);
  const corners z = give(r, e.u.z, e.v.z, &s);
  add(&view->sum[of[0]], x.one + x.two, y.one + y.two, z.one + z.two);
  add(&view->sum[of[1]], -x.one, -y.one, -z.one);
  add(&view->sum[of[2]], -x.two, -y.two, -z.two);
}

void pull_triangles(fray_world *w) {
  const pull_view view = {w->places, w->sums, w->sheet.triangle, w->sheet.weights, w->pull};
  const uint32_t count = (uint32_t)w->sheet.state->triangles;
  uint32_t t = 0;
  while (t < count) {
    t += wide_pull(w->kernel, &view, t, count);
    if (t < count) pull_triangle(&view, t++);
  }
  w->work.pulls += count;
}
