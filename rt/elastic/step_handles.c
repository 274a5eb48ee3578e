/* SPDX-License-Identifier: Apache-2.0 */
/* The spring acts at the positions where a step begins, as all forces of it. Seen from the proxy,
 * which moves evenly through a tick, that is the step of any spring: it gains nothing. The damper
 * acts at the velocity behind it, by no more than what would stop the body beside the proxy: an
 * impulse that always takes energy. What the proxy's velocity gives, by the mean of the spring's
 * forces on its way, is the work of the hand.
 *
 * A handle weighs nothing: the device feels the cloth. */
#include "rt/elastic/step_handles.h"

#include "rt/integrate/integrate.h"

#if FRAY_HANDLES

enum { IMPULSE_MAX_BITS = 44 };

static int64_t bounded_impulse(int64_t j) {
  return fx_clamp64(j, -((int64_t)1 << IMPULSE_MAX_BITS), (int64_t)1 << IMPULSE_MAX_BITS);
}

/* Where the body is, Q28 lu. */
static int64_t body_place(const elastic_body *e, uint32_t n) {
  const int32_t start = n == 0 ? e->start.x : n == 1 ? e->start.y : e->start.z;
  return (int64_t)start * (1 << FX_SUB_BITS) +
         fx_wrap_sub(e->at[n], fx_wrap_shift(start, FX_SUB_BITS));
}

/* Q28 lu per substep. */
static int32_t proxy_speed(const fray_world *w, const handle_motion *m, uint32_t n) {
  return fx_saturate(((int64_t)m->to[n] - m->from[n]) * (1 << FX_SUB_BITS) / w->params->substeps);
}

static void pull_axis(fray_world *w, uint32_t h, uint32_t n, int32_t gravity) {
  const handle_params *k = &w->handles.constants[h];
  handle_motion *m = &w->handles.motion[h];
  const uint32_t b = (uint32_t)k->body;
  int32_t *speed = &w->rigid.states[b].velocity[n];
  const int32_t extension = handle_extension(m->at[n], body_place(&w->membrane.bodies[b], n));
  const int64_t spring = bounded_impulse(handle_spring_impulse(k, extension));
  *speed = fx_saturate((int64_t)*speed - gravity);
  body_gain(w, b, n, spring);
  const int32_t slip = fx_saturate((int64_t)*speed - proxy_speed(w, m, n));
  const int64_t damper = bounded_impulse(-fx_round64(fx_mul_wide(slip, k->damping), HANDLE_GAIN_BITS));
  body_gain(w, b, n, damper);
  m->impulse[n] += spring + damper;
#if FRAY_ENERGY
  m->by_spring[n] = spring;
  m->by_damper[n] = damper;
#endif
}

static void pull_handle(fray_world *w, uint32_t h, const elastic_step *step, int32_t part) {
  handle_motion *m = &w->handles.motion[h];
  const int64_t parts = (int64_t)w->params->substeps * w->membrane.constants->steps;
  FRAY_ASSERT(part >= 0 && part < parts);
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t way = ((int64_t)m->to[n] - m->from[n]) * (1 << FX_SUB_BITS);
    pull_axis(w, h, n, step->gravity[n]);
    m->at[n] = (int64_t)m->from[n] * (1 << FX_SUB_BITS) + way * (part + 1) / parts;
  }
}

void step_handles_begin(fray_world *w) {
  FRAY_ASSERT(world_has_handles(w) && world_has_membrane(w));
  for (uint32_t h = 0; h < FRAY_HANDS; ++h) {
    handle_motion *m = &w->handles.motion[h];
    for (uint32_t n = 0; n < 3; ++n) {
      m->at[n] = (int64_t)m->from[n] * (1 << FX_SUB_BITS);
      m->impulse[n] = 0;
    }
  }
}

void step_handles_pull(fray_world *w, const elastic_step *step, int32_t part) {
  FRAY_ASSERT(world_has_handles(w) && step->part > 0);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    if (w->handles.constants[h].body != HANDLE_NONE) pull_handle(w, h, step, part);
}

#if FRAY_ENERGY

void step_handles_mark_add(fray_world *w) {
  FRAY_ASSERT(world_has_handles(w));
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    for (uint32_t n = 0; n < 3 && w->handles.constants[h].body != HANDLE_NONE; ++n)
      w->handles.motion[h].speed[n] = w->rigid.states[w->handles.constants[h].body].velocity[n];
}

/* By the mean of the velocities before and behind all impulses of the step. */
static void meter_axis(fray_world *w, uint32_t h, uint32_t n) {
  const handle_params *k = &w->handles.constants[h];
  const handle_motion *m = &w->handles.motion[h];
  const int32_t speed = w->rigid.states[k->body].velocity[n];
  const int32_t proxy = proxy_speed(w, m, n);
  const int64_t twice_slip = (int64_t)m->speed[n] + speed - 2 * (int64_t)proxy;
  const int64_t parting = ((int64_t)proxy - speed) / w->membrane.constants->steps;
  const int64_t growth = bounded_impulse(handle_spring_impulse(k, fx_saturate(parting)));
  const wide_number work = wide_product(2 * (m->by_spring[n] + m->by_damper[n]) + growth, proxy,
                                        2u * FX_VELOCITY_BITS + 1u);
  const wide_number lost = wide_product(m->by_damper[n], twice_slip, 2u * FX_VELOCITY_BITS + 1u);
  energy_ledger *l = &w->energy;
  l->supplied[FRAY_SUPPLIED_HANDS] = wide_add(l->supplied[FRAY_SUPPLIED_HANDS], work);
  l->stage[FRAY_ENERGY_DAMPING] = wide_add(l->stage[FRAY_ENERGY_DAMPING], lost);
  l->booked = wide_add(l->booked, wide_add(work, lost));
}

void step_handles_meter_add(fray_world *w) {
  FRAY_ASSERT(world_has_handles(w));
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    for (uint32_t n = 0; n < 3 && w->handles.constants[h].body != HANDLE_NONE; ++n) meter_axis(w, h, n);
}

#endif

#endif
