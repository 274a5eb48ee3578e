/* SPDX-License-Identifier: Apache-2.0 */
/* Inner steps of triangle sheets: a substep of predict, with the stress and the bending, which want
 * shorter ones. */
#include "rt/stage/stage.h"
#include "rt/wide/wide.h"

/* Of a whole that is divided among so many: what part n gets. Floors, which add up to the whole. */
static int32_t part_of(int32_t whole, int32_t n, int32_t all) {
  const int64_t before = (int64_t)whole * n;
  const int64_t after = before + whole;
  const int64_t low = before >= 0 ? before / all : -((-before + all - 1) / all);
  const int64_t high = after >= 0 ? after / all : -((-after + all - 1) / all);
  return (int32_t)(high - low);
}

static inner_view view_of(fray_world *w) {
  const int32_t steps = w->cloths->inner * w->params->substeps;
  const inner_view view = {w->places, w->sums, {w->vx, w->vy, w->vz}, {w->low_x, w->low_y, w->low_z},
                           w->inverse, {0, 0, 0},
                           fx_saturate((int64_t)(((uint64_t)1 << 31) / (uint32_t)w->cloths->inner)),
                           (int32_t)(((uint64_t)(uint32_t)w->params->drag << 6) / (uint32_t)steps), 0};
  return view;
}

/* Drag comes in every inner step: once a tick it would meet vibrations whose period fits into a tick in one
 * phase, and some gain by that. What it takes is below one most of the time, so it is rounded by another
 * threshold in each step. */
static void begin_step(const fray_world *w, inner_view *view, uint32_t substep, int32_t step) {
  const int32_t inner = w->cloths->inner;
  const int32_t gravity[3] = {w->gravity_step.x, w->gravity_step.y, w->gravity_step.z};
  const uint32_t steps = (uint32_t)inner * (uint32_t)w->params->substeps;
  const uint32_t count =
      fx_wrap_mul_u((uint32_t)w->state->tick, steps) + substep * (uint32_t)inner + (uint32_t)step;
  for (uint32_t n = 0; n < 3; ++n) view->gravity[n] = part_of(gravity[n], step, inner);
  view->dither = (int32_t)(fx_wrap_mul_u(count, 2654435769u) >> 2);
}

static inline int32_t dragged(const inner_view *k, int32_t speed) {
  const int32_t lost = (int32_t)((fx_mul_wide((int32_t)fx_magnitude(speed), k->drag) + k->dither) >> 30);
  return speed < 0 ? speed + lost : speed - lost;
}

static inline void step_axis(const inner_view *k, uint32_t p, uint32_t n, int32_t sum) {
  const int64_t pulled = fx_round64(fx_mul_wide(sum, k->inverse[p]),
                                    INNER_PULL_BITS + INNER_INVERSE_BITS - FX_VELOCITY_BITS);
  const int32_t speed =
      dragged(k, (int32_t)fx_clamp64(k->v[n][p] + pulled, -FX_SPEED_MAX, FX_SPEED_MAX)) + k->gravity[n];
  const int64_t way = fx_mul_wide(speed, k->part) + k->low[n][p];
  int32_t *at = &k->place[p].at[n];
  k->v[n][p] = speed;
  k->low[n][p] = (int32_t)(way & INT32_MAX);
  *at = fx_wrap_add(*at, (int32_t)fx_asr64(way, INNER_LOW_BITS));
}

static void step_vertex(const inner_view *k, uint32_t p) {
  step_axis(k, p, 0, k->sum[p].x);
  step_axis(k, p, 1, k->sum[p].y);
  step_axis(k, p, 2, k->sum[p].z);
  k->place[p].below = inner_below(k->low[0][p], k->low[1][p], k->low[2][p]);
}

/* A body that holds vertices carries them, and feels what pulls at them. */
static void carry(fray_world *w, uint32_t p, int32_t step) {
  enum { MORE_BITS = FX_VELOCITY_BITS - INNER_PULL_BITS };
  body_motion *m = &w->motion[w->grip_body[p]];
  const int32_t moved[3] = {m->moved.x, m->moved.y, m->moved.z};
  const int32_t sum[3] = {w->sums[p].x, w->sums[p].y, w->sums[p].z};
  for (uint32_t n = 0; n < 3; ++n) {
    int32_t *at = &w->places[p].at[n];
    m->impulse[n] = fx_add64(m->impulse[n], -(int64_t)sum[n] * (1 << MORE_BITS));
    if (moved[n] != 0) *at = fx_wrap_add(*at, part_of(fx_wrap_shift(moved[n], FX_SUB_BITS), step, w->cloths->inner));
  }
}

static void step_vertices(fray_world *w, const inner_view *view, int32_t step) {
  const uint32_t held = (uint32_t)w->params->held;
  for (uint32_t p = 0; p < held; ++p) carry(w, p, step);
  uint32_t p = held;
  while (p < w->particles) {
    p += wide_inner(w->kernel, view, p, w->particles);
    if (p < w->particles) step_vertex(view, p++);
  }
}

static int32_t fine(int32_t x, int32_t r) { return fx_wrap_add(fx_wrap_shift(x, FX_SUB_BITS), r); }

/* What a held vertex has below Q24 is its body's. */
static int32_t rest_of(const fray_world *w, const int8_t *r, uint32_t p) {
  return p < (uint32_t)w->params->held ? 0 : r[p];
}

static void begin_inner(fray_world *w) {
  const int32_t half = 1 << (INNER_LOW_BITS - 1); /* so that what end_inner() drops is rounded */
  for (uint32_t p = 0; p < w->particles; ++p) {
    inner_place *place = &w->places[p];
    place->at[0] = fine(w->x[p], rest_of(w, w->rx, p));
    place->at[1] = fine(w->y[p], rest_of(w, w->ry, p));
    place->at[2] = fine(w->z[p], rest_of(w, w->rz, p));
    place->below = inner_below(half, half, half);
    w->low_x[p] = w->low_y[p] = w->low_z[p] = half;
  }
}

static void begin_sums(fray_world *w) {
  for (uint32_t p = 0; p < w->particles; ++p) w->sums[p] = w->given[p];
}

/* Back to Q24 and 8 bits; what is below Q28 is dropped, less than half a step of velocity. Returns not 0
 * where it is at the edge of the world. */
static uint32_t end_axis(int32_t *x, int32_t *q, int8_t *r, int32_t at) {
  const int32_t way = fx_add(fx_wrap_sub(at, fine(*x, *r)), *r);
  const int32_t whole = fx_round(way, FX_SUB_BITS);
  const int32_t moved = fx_add(*x, whole);
  const int32_t place = fx_clamp(moved, -FX_WORLD_MAX, FX_WORLD_MAX);
  *r = (int8_t)(way - whole * (1 << FX_SUB_BITS));
  *x = *q = place;
  return (uint32_t)(moved ^ place);
}

static void end_inner(fray_world *w) {
  uint32_t at_edge = 0;
  for (uint32_t p = (uint32_t)w->params->held; p < w->particles; ++p) {
    const int32_t *at = w->places[p].at;
    at_edge |= end_axis(&w->x[p], &w->qx[p], &w->rx[p], at[0]);
    at_edge |= end_axis(&w->y[p], &w->qy[p], &w->ry[p], at[1]);
    at_edge |= end_axis(&w->z[p], &w->qz[p], &w->rz[p], at[2]);
  }
  if (at_edge != 0) w->state->faults |= (int32_t)FRAY_FAULT_LEFT_WORLD;
}

void inner_run(fray_world *w, uint32_t substep) {
  const int32_t inner = w->cloths->inner;
  inner_view view = view_of(w);
  begin_inner(w);
  for (int32_t step = 0; step < inner; ++step) {
    begin_sums(w);
    pull_triangles(w);
    if (w->cloths->bend_every != 0 && step % w->cloths->bend_every == 0) fold_sides(w);
    begin_step(w, &view, substep, step);
    step_vertices(w, &view, step);
  }
  end_inner(w);
  w->work.predictions += (w->particles - (uint32_t)w->params->held) * (uint32_t)inner;
}
