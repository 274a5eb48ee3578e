/* SPDX-License-Identifier: Apache-2.0 */
/* The stress of triangles moves their vertices (Karaoz 2015, 2.32), explicitly, in inner steps of a
 * substep: with it goes all that a substep of predict does.
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

enum { PULL_BITS = 26, PULL_MORE_BITS = 4, PULL_MAX = (1 << 26) - (1 << 22), INVERSE_BITS = 24 };
/* Inner steps carry 31 bits below Q28: where positions of triangles are rounded in each, it sounds in the
 * stress of stiff sheets, a dozen times louder than all other rounding. */
enum {
  LOW_BITS = 31,
  WAY_MORE_BITS = 2,
  WAY_BITS = FX_VELOCITY_BITS + WAY_MORE_BITS,
  WAY_REACH = (1 << 29) - 1
};

static void weigh_vertices(fray_world *w) {
  const uint64_t unit = (uint64_t)(uint32_t)w->cloths->unit << INVERSE_BITS;
  for (uint32_t p = 0; p < w->particles; ++p) {
    const uint32_t inverse = fx_divide_wide(unit, w->sheet.mass[p]);
    w->inverse[p] = inverse > INT32_MAX ? INT32_MAX : (int32_t)inverse;
  }
}

/* A triangle that a tear or a cut left lower than inner steps of this length can bear is as much softer.
 * The square of a weight's length is that of 1 / height. Q30 of what is left. */
static int32_t left_of(const fray_world *w, uint32_t t) {
  const sheet_weights *r = &w->sheet.weights[t];
  const uint64_t ends[3] = {fx_square(r->u1) + fx_square(r->v1), fx_square(r->u2) + fx_square(r->v2),
                            fx_square(fx_add(r->u1, r->u2)) + fx_square(fx_add(r->v1, r->v2))};
  const uint64_t more = ends[0] > ends[1] ? ends[0] : ends[1];
  const uint64_t most = (more > ends[2] ? more : ends[2]) >> 32; /* Q12 */
  const uint32_t steep = (uint32_t)w->cloths->steep;
  return most <= steep ? 1 << 30 : (int32_t)fx_divide_wide((uint64_t)steep << 30, (uint32_t)most);
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

void stress_run(fray_world *w) {
  if (!world_has_sheet(w)) return;
  const sheet_mesh *s = &w->sheet;
  for (uint32_t t = 0; t < (uint32_t)s->state->triangles; ++t) {
    const element_axes e = element_axes_of(w, t);
    const tensor strain = fabric_strain(e.u, e.v);
    int32_t *c = w->pull[t].c;
    const int32_t left = left_of(w, t);
    fabric_stiffness(&w->fabrics[s->cloth[t]],
                     get_used_to(&w->habits[t], strain, (unsigned)w->cloths->habit_shift), c);
    w->stress[t] = fabric_stress(c, strain);
    if (left == 1 << 30) continue;
    w->stress[t].uu = (int32_t)fx_round64(fx_mul_wide(w->stress[t].uu, left), 30);
    w->stress[t].vv = (int32_t)fx_round64(fx_mul_wide(w->stress[t].vv, left), 30);
    w->stress[t].uv = (int32_t)fx_round64(fx_mul_wide(w->stress[t].uv, left), 30);
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

static inline void give(int32_t *sum, const sheet_triangle *f, const sheet_weights *r, int32_t u, int32_t v,
                        const tensor *s) {
  const int32_t p1 = bounded(fx_mul_wide(s->uu, u) + fx_mul_wide(s->uv, v));
  const int32_t p2 = bounded(fx_mul_wide(s->uv, u) + fx_mul_wide(s->vv, v));
  const int32_t one = corner(p1, p2, r->u1, r->v1);
  const int32_t two = corner(p1, p2, r->u2, r->v2);
  sum[f->v[0]] = fx_add(sum[f->v[0]], one + two);
  sum[f->v[1]] = fx_sub(sum[f->v[1]], one);
  sum[f->v[2]] = fx_sub(sum[f->v[2]], two);
}

/* Q30, right as long as corners are less than 8 lu apart; farther than 2 they count as 2. */
static inline int32_t way_of(const int32_t *q, const int32_t *low, uint32_t from, uint32_t to) {
  const int32_t whole = fx_clamp_rare(fx_wrap_sub(q[to], q[from]), -WAY_REACH, WAY_REACH);
  return whole * (1 << WAY_MORE_BITS) + fx_asr(low[to], LOW_BITS - WAY_MORE_BITS) -
         fx_asr(low[from], LOW_BITS - WAY_MORE_BITS);
}

static void pull_triangle(fray_world *w, uint32_t t) {
  const sheet_triangle *f = &w->sheet.triangle[t];
  const sheet_weights *r = &w->sheet.weights[t];
  const int32_t *c = w->pull[t].c;
  const vec3 d1 = {way_of(w->qx, w->low_x, f->v[0], f->v[1]), way_of(w->qy, w->low_y, f->v[0], f->v[1]),
                   way_of(w->qz, w->low_z, f->v[0], f->v[1])};
  const vec3 d2 = {way_of(w->qx, w->low_x, f->v[0], f->v[2]), way_of(w->qy, w->low_y, f->v[0], f->v[2]),
                   way_of(w->qz, w->low_z, f->v[0], f->v[2])};
  const element_axes e = element_axes_by(d1, d2, r, WAY_BITS);
  const tensor g = fabric_strain(e.u, e.v);
  const tensor s = {bounded(fx_mul_wide(c[0], g.uu) + fx_mul_wide(c[1], g.vv)),
                    bounded(fx_mul_wide(c[1], g.uu) + fx_mul_wide(c[2], g.vv)),
                    bounded(fx_mul_wide(c[3], g.uv))};
  give(w->sum_x, f, r, e.u.x, e.v.x, &s);
  give(w->sum_y, f, r, e.u.y, e.v.y, &s);
  give(w->sum_z, f, r, e.u.z, e.v.z, &s);
}

/* Of a whole that is divided among so many: what part n gets. Floors, which add up to the whole. */
static int32_t part_of(int32_t whole, int32_t n, int32_t all) {
  const int64_t before = (int64_t)whole * n;
  const int64_t after = before + whole;
  const int64_t low = before >= 0 ? before / all : -((-before + all - 1) / all);
  const int64_t high = after >= 0 ? after / all : -((-after + all - 1) / all);
  return (int32_t)(high - low);
}

/* One inner step of one axis: x in Q28, v in Q28 per substep. */
typedef struct {
  int32_t gravity;
  int32_t part;   /* 2^31 / inner */
  int32_t drag;   /* Q30 */
  int32_t dither; /* Q30 of 0..1 */
} inner_step;

/* Drag comes in every inner step: once a tick it would meet vibrations whose period fits into a tick in one
 * phase, and some gain by that. What it takes is below one most of the time, so it is rounded by another
 * threshold in each step. */
static inline int32_t dragged(const inner_step *k, int32_t speed) {
  const int32_t lost = (int32_t)((fx_mul_wide((int32_t)fx_magnitude(speed), k->drag) + k->dither) >> 30);
  return speed < 0 ? speed + lost : speed - lost;
}

static inner_step inner_step_of(const fray_world *w, int32_t gravity, uint32_t substep, int32_t step) {
  const int32_t inner = w->cloths->inner;
  const uint32_t steps = (uint32_t)inner * (uint32_t)w->params->substeps;
  const uint32_t count = fx_wrap_mul_u((uint32_t)w->state->tick, steps) + substep * (uint32_t)inner + (uint32_t)step;
  const inner_step k = {part_of(gravity, step, inner),
                        fx_saturate((int64_t)(((uint64_t)1 << 31) / (uint32_t)inner)),
                        (int32_t)(((uint64_t)(uint32_t)w->params->drag << 6) / steps),
                        (int32_t)(fx_wrap_mul_u(count, 2654435769u) >> 2)};
  return k;
}

static inline void step_axis(const inner_step *k, int32_t *x, int32_t *v, int32_t *low, int32_t sum,
                             int32_t inverse) {
  const int64_t pulled = fx_round64(fx_mul_wide(sum, inverse), PULL_BITS + INVERSE_BITS - FX_VELOCITY_BITS);
  const int32_t speed =
      dragged(k, (int32_t)fx_clamp64(*v + pulled, -FX_SPEED_MAX, FX_SPEED_MAX)) + k->gravity;
  const int64_t way = fx_mul_wide(speed, k->part) + *low;
  *v = speed;
  *low = (int32_t)(way & INT32_MAX);
  *x = fx_wrap_add(*x, (int32_t)fx_asr64(way, LOW_BITS));
}

static void hold(fray_world *w, int32_t *sum, uint32_t n) {
  for (uint32_t p = 0; p < (uint32_t)w->params->held; ++p) {
    int64_t *impulse = &w->motion[w->grip_body[p]].impulse[n];
    *impulse = fx_add64(*impulse, -(int64_t)sum[p] * (1 << (FX_VELOCITY_BITS - PULL_BITS)));
  }
}

/* The state of one axis: x stays until the end, q goes through the inner steps, in Q28 with what x has
 * below Q24, and wraps. */
typedef struct {
  int32_t *x, *q, *v, *sum, *low;
  const int32_t *given;
  int8_t *r;
  int32_t gravity;
} axis;

static int32_t fine(int32_t x, int32_t r) { return fx_wrap_add(fx_wrap_shift(x, FX_SUB_BITS), r); }

static void begin_inner(const fray_world *w, const axis *a) {
  for (uint32_t p = 0; p < w->particles; ++p) {
    a->q[p] = fine(a->x[p], p < (uint32_t)w->params->held ? 0 : a->r[p]);
    a->low[p] = 1 << (LOW_BITS - 1); /* so that what end_inner() drops is rounded */
  }
}

static void begin_sums(const fray_world *w, const axis *a) {
  for (uint32_t p = 0; p < w->particles; ++p) a->sum[p] = a->given[p];
}

static void step_vertices(fray_world *w, const axis *a, uint32_t n, uint32_t substep, int32_t step) {
  const uint32_t held = (uint32_t)w->params->held;
  const int32_t inner = w->cloths->inner;
  const inner_step k = inner_step_of(w, a->gravity, substep, step);
  hold(w, a->sum, n);
  for (uint32_t p = 0; p < held; ++p) {
    const body_motion *m = &w->motion[w->grip_body[p]];
    const int32_t moved[3] = {m->moved.x, m->moved.y, m->moved.z};
    if (moved[n] != 0) a->q[p] = fx_wrap_add(a->q[p], part_of(fx_wrap_shift(moved[n], FX_SUB_BITS), step, inner));
  }
  for (uint32_t p = held; p < w->particles; ++p)
    step_axis(&k, &a->q[p], &a->v[p], &a->low[p], a->sum[p], w->inverse[p]);
}

/* Back to Q24 and 8 bits; what is below Q28 is dropped, less than half a step of velocity. */
static uint32_t end_inner(const fray_world *w, const axis *a) {
  uint32_t at_edge = 0;
  for (uint32_t p = (uint32_t)w->params->held; p < w->particles; ++p) {
    const int32_t way = fx_add(fx_wrap_sub(a->q[p], fine(a->x[p], a->r[p])), a->r[p]);
    const int32_t whole = fx_round(way, FX_SUB_BITS);
    const int32_t moved = fx_add(a->x[p], whole);
    const int32_t place = fx_clamp(moved, -FX_WORLD_MAX, FX_WORLD_MAX);
    a->r[p] = (int8_t)(way - whole * (1 << FX_SUB_BITS));
    at_edge |= (uint32_t)(moved ^ place);
    a->x[p] = a->q[p] = place;
  }
  return at_edge;
}

void pull_run(fray_world *w, uint32_t substep) {
  const axis axes[3] = {
      {w->x, w->qx, w->vx, w->sum_x, w->low_x, w->given_x, w->rx, w->gravity_step.x},
      {w->y, w->qy, w->vy, w->sum_y, w->low_y, w->given_y, w->ry, w->gravity_step.y},
      {w->z, w->qz, w->vz, w->sum_z, w->low_z, w->given_z, w->rz, w->gravity_step.z}};
  const uint32_t triangles = (uint32_t)w->sheet.state->triangles;
  const int32_t inner = w->cloths->inner;
  uint32_t at_edge = 0;
  for (uint32_t n = 0; n < 3; ++n) begin_inner(w, &axes[n]);
  for (int32_t step = 0; step < inner; ++step) {
    for (uint32_t n = 0; n < 3; ++n) begin_sums(w, &axes[n]);
    for (uint32_t t = 0; t < triangles; ++t) pull_triangle(w, t);
    if (w->cloths->bend_every != 0 && step % w->cloths->bend_every == 0) fold_sides(w);
    for (uint32_t n = 0; n < 3; ++n) step_vertices(w, &axes[n], n, substep, step);
  }
  for (uint32_t n = 0; n < 3; ++n) at_edge |= end_inner(w, &axes[n]);
  if (at_edge != 0) w->state->faults |= (int32_t)FRAY_FAULT_LEFT_WORLD;
  w->work.predictions += (w->particles - (uint32_t)w->params->held) * (uint32_t)inner;
  w->work.pulls += triangles * (uint32_t)inner;
}
