/* SPDX-License-Identifier: Apache-2.0 */
/* An elastic step of the membrane, one of the `steps` shorter steps of symplectic Euler within a substep, as
 * stress and bending are too stiff for one: tick/elastic_steps.c is their loop. SIMD twin of a step:
 * rt/simd/membrane_step_lanes.inl.h.
 *
 *   impulse      loads, stress (membrane_force.c), bending (bend_force.c), limits and contacts, Q26 masses of
 *                a particle times lu per substep
 *   velocity     += impulse * inverse mass, less drag, plus gravity; Q28 lu per substep
 *   position     += velocity / steps; Q28 lu, and 31 bits below it */
#include "rt/base/bytes.h"
#include "rt/membrane/membrane.h"
#include "rt/membrane/step_meter.h"
#include "rt/simd/simd.h"

static step_view view_of(fray_world *w) {
  const int32_t steps = w->membrane.constants->steps;
  const step_view view = {w->membrane.positions,
                          w->membrane.impulse,
                          {w->p.vx, w->p.vy, w->p.vz},
                          {w->membrane.low_x, w->membrane.low_y, w->membrane.low_z},
                          w->membrane.inverse_mass,
                          {0, 0, 0},
                          fx_saturate((int64_t)(((uint64_t)1 << 31) / (uint32_t)steps)),
                          (int32_t)(((uint64_t)(uint32_t)w->params->drag << 6) /
                                    (uint32_t)(steps * w->params->substeps)),
                          0};
  return view;
}

/* Drag acts in every elastic step: once a tick it would meet vibrations whose period fits into a tick at
 * always the same phase, and some would gain energy by that. It takes less than one unit most of the time, so
 * it is rounded by another threshold in each step (`dither`, a golden ratio sequence of period 2^32 steps, so
 * the low word of the tick is enough). */
static void begin_step(const fray_world *w, step_view *view, uint32_t substep, int32_t step) {
  const int32_t steps = w->membrane.constants->steps;
  const int32_t gravity[3] = {w->gravity_step.x, w->gravity_step.y, w->gravity_step.z};
  const uint32_t steps_a_tick = (uint32_t)steps * (uint32_t)w->params->substeps;
  const uint32_t number =
      fx_wrap_mul_u((uint32_t)w->state->tick[0], steps_a_tick) + substep * (uint32_t)steps + (uint32_t)step;
  for (uint32_t n = 0; n < 3; ++n) view->gravity[n] = step_part_of(gravity[n], step, steps);
  view->dither = (int32_t)(fx_wrap_mul_u(number, 2654435769u) >> 2);
}

static inline int32_t apply_drag(const step_view *k, int32_t speed) {
  const int32_t lost = (int32_t)((fx_mul_wide((int32_t)fx_magnitude(speed), k->drag) + k->dither) >> 30);
  return speed < 0 ? speed + lost : speed - lost;
}

static inline void step_axis(const step_view *k, uint32_t p, uint32_t n, int32_t impulse) {
  const int64_t change = fx_round64(fx_mul_wide(impulse, k->inverse[p]),
                                    ELASTIC_IMPULSE_BITS + ELASTIC_INVERSE_BITS - FX_VELOCITY_BITS);
  const int32_t speed =
      apply_drag(k, fx_clamp_wide(k->v[n][p] + change, FX_SPEED_MAX)) + k->gravity[n];
  const int64_t travel = fx_mul_wide(speed, k->part) + k->low[n][p];
  int32_t *at = &k->place[p].at[n];
  k->v[n][p] = speed;
  k->low[n][p] = (int32_t)(travel & INT32_MAX);
  *at = fx_wrap_add(*at, (int32_t)fx_asr64(travel, ELASTIC_LOW_BITS));
}

static void step_vertex(const step_view *k, uint32_t p) {
  step_axis(k, p, 0, k->sum[p].x);
  step_axis(k, p, 1, k->sum[p].y);
  step_axis(k, p, 2, k->sum[p].z);
  k->place[p].low_bits = elastic_low_bits(k->low[0][p], k->low[1][p], k->low[2][p]);
}

static int32_t to_q28(int32_t x, int32_t remainder) {
  return fx_wrap_add(fx_wrap_shift(x, FX_SUB_BITS), remainder);
}

/* The remainder of an attached vertex is that of its body. */
static int32_t remainder_of(const fray_world *w, const int8_t *r, uint32_t p, uint32_t axis) {
  return p < particles_attached(w) ? w->rigid.states[w->p.attach_body[p]].remainder[axis] : r[p];
}

static void begin_steps(fray_world *w) {
  FRAY_ASSERT(w->p.count <= w->capacity[POOL_PARTICLES]);
  const int32_t half = 1 << (ELASTIC_LOW_BITS - 1); /* so that what end_steps() drops is rounded */
  for (uint32_t p = 0; p < w->p.count; ++p) {
    elastic_position *place = &w->membrane.positions[p];
    place->at[0] = to_q28(w->p.x[p], remainder_of(w, w->p.rx, p, 0));
    place->at[1] = to_q28(w->p.y[p], remainder_of(w, w->p.ry, p, 1));
    place->at[2] = to_q28(w->p.z[p], remainder_of(w, w->p.rz, p, 2));
    place->low_bits = elastic_low_bits(half, half, half);
    w->membrane.low_x[p] = w->membrane.low_y[p] = w->membrane.low_z[p] = half;
  }
}

static void begin_impulses(fray_world *w) {
  for (uint32_t p = 0; p < w->p.count; ++p) w->membrane.impulse[p] = w->membrane.external_impulse[p];
}

/* Back to Q24 and 8 bits; what is below Q28 is dropped, less than half a unit of velocity. Returns not 0
 * where it is at the edge of the world. */
static uint32_t end_axis(int32_t *x, int32_t *q, int8_t *r, int32_t at) {
  const int32_t travel = fx_add(fx_wrap_sub(at, to_q28(*x, *r)), *r);
  const int32_t whole = fx_round(travel, FX_SUB_BITS);
  const int32_t moved = fx_add(*x, whole);
  const int32_t place = fx_clamp(moved, -FX_WORLD_MAX, FX_WORLD_MAX);
  *r = (int8_t)(travel - whole * (1 << FX_SUB_BITS));
  *x = *q = place;
  return (uint32_t)(moved ^ place);
}

/* Drag and gravity come behind the clamp: it is told by what is near the limit. */
enum { NEAR_SPEED_MAX = FX_SPEED_MAX / 64 * 63 };

static void end_steps(fray_world *w) {
  uint32_t at_edge = 0;
  int is_slow = 1;
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    const int32_t *at = w->membrane.positions[p].at;
    at_edge |= end_axis(&w->p.x[p], &w->p.qx[p], &w->p.rx[p], at[0]);
    at_edge |= end_axis(&w->p.y[p], &w->p.qy[p], &w->p.ry[p], at[1]);
    at_edge |= end_axis(&w->p.z[p], &w->p.qz[p], &w->p.rz[p], at[2]);
    is_slow &= vec_is_within(world_velocity(w, p), NEAR_SPEED_MAX);
  }
  if (at_edge != 0) world_fault(w, FRAY_FAULT_OUT_OF_WORLD);
  if (!is_slow) world_fault(w, FRAY_FAULT_SPEED_LIMIT);
}

#if FRAY_ENERGY
void membrane_impulses_now(fray_world *w) {
  const fray_work work = w->work;
  const int32_t faults = w->state->faults;
  FRAY_ASSERT(world_has_membrane(w));
  begin_steps(w);
  bytes_zero(w->membrane.impulse, w->p.count * sizeof *w->membrane.impulse);
  membrane_force_add(w, FORCE_MEASURED);
  if (w->membrane.constants->bend_every != 0) bend_force_add(w, BEND_MEASURED);
  w->work = work;
  w->state->faults = faults;
}
#endif

void membrane_angles_find(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w));
  begin_steps(w);
  bend_angles_find(w);
}

step_view membrane_step_begin(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w) && w->p.count <= w->capacity[POOL_PARTICLES]);
  begin_steps(w);
  return view_of(w);
}

elastic_step membrane_step_force(fray_world *w, step_view *view, uint32_t substep, int32_t number) {
  const int32_t bend_every = w->membrane.constants->bend_every;
  const int is_last = substep + 1u == (uint32_t)w->params->substeps &&
                      w->membrane.constants->steps - number <= bend_every;
  FRAY_ASSERT(substep < (uint32_t)w->params->substeps && number < w->membrane.constants->steps);
  begin_impulses(w);
  membrane_force_add(w, substep == 0 && number == 0 ? FORCE_FIRST : FORCE_STEP);
  step_meter_damping(w);
  if (bend_every != 0 && number % bend_every == 0)
    bend_force_add(w, is_last ? BEND_LAST : BEND_STEP);
  begin_step(w, view, substep, number);
  const elastic_step step = {{view->gravity[0], view->gravity[1], view->gravity[2]},
                             view->part,
                             step_rise_of(w)};
  return step;
}

void membrane_step_move(fray_world *w, const step_view *view) {
  const uint32_t count = w->p.count;
  uint32_t p = particles_attached(w);
  while (p < count) {
    p += simd_membrane_step(w->kernel, view, p, count);
    if (p < count) step_vertex(view, p++);
  }
  step_meter(w, view);
  w->work.particle_steps += count - particles_attached(w);
}

void membrane_step_end(fray_world *w) {
  FRAY_ASSERT(world_has_membrane(w));
  end_steps(w);
}
