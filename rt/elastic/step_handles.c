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

/* Of one step, along an axis. */
typedef struct {
  int64_t spring, damper; /* Q28, what the body gains */
  int64_t growth;         /* what the spring's will be more in the next step */
  int32_t proxy_speed;    /* Q28 lu per substep, as these: */
  int64_t twice_slip;     /* of the body beside its proxy, when the step began and behind it */
} coupled_axis;

static int64_t bounded_impulse(int64_t j) {
  return fx_clamp64(j, -((int64_t)1 << IMPULSE_MAX_BITS), (int64_t)1 << IMPULSE_MAX_BITS);
}

/* Where the body is, Q28 lu. */
static int64_t body_place(const elastic_body *e, uint32_t n) {
  const int32_t start = n == 0 ? e->start.x : n == 1 ? e->start.y : e->start.z;
  return (int64_t)start * (1 << FX_SUB_BITS) +
         fx_wrap_sub(e->at[n], fx_wrap_shift(start, FX_SUB_BITS));
}

static void meter_axis_of_handle(fray_world *w, const coupled_axis *a) {
#if FRAY_ENERGY
  energy_ledger *l = &w->energy;
  if (!l->watched) return;
  const wide_number work = wide_product(2 * (a->spring + a->damper) + a->growth, a->proxy_speed,
                                        2u * FX_VELOCITY_BITS + 1u);
  const wide_number lost = wide_product(a->damper, a->twice_slip, 2u * FX_VELOCITY_BITS + 1u);
  l->supplied[FRAY_SUPPLIED_HANDS] = wide_add(l->supplied[FRAY_SUPPLIED_HANDS], work);
  l->stage[FRAY_ENERGY_DAMPING] = wide_add(l->stage[FRAY_ENERGY_DAMPING], lost);
  l->booked = wide_add(l->booked, wide_add(work, lost));
#else
  (void)w;
  (void)a;
#endif
}

static void pull_axis(fray_world *w, uint32_t h, uint32_t n, int32_t gravity) {
  const handle_params *k = &w->handles.constants[h];
  handle_motion *m = &w->handles.motion[h];
  const uint32_t b = (uint32_t)k->body;
  int32_t *speed = &w->rigid.states[b].velocity[n];
  const int64_t way = ((int64_t)m->to[n] - m->from[n]) * (1 << FX_SUB_BITS);
  coupled_axis a;
  a.proxy_speed = fx_saturate(way / w->params->substeps);
  const int32_t extension = handle_extension(m->at[n], body_place(&w->membrane.bodies[b], n));
  a.spring = bounded_impulse(handle_spring_impulse(k, extension));
  *speed = fx_saturate((int64_t)*speed - gravity);
  body_gain(w, b, n, a.spring);
  const int32_t slip = fx_saturate((int64_t)*speed - a.proxy_speed);
  a.damper = bounded_impulse(-fx_round64(fx_mul_wide(slip, k->damping), HANDLE_GAIN_BITS));
  body_gain(w, b, n, a.damper);
  a.twice_slip = (int64_t)m->speed[n] + *speed - 2 * (int64_t)a.proxy_speed;
  const int64_t parting = ((int64_t)a.proxy_speed - *speed) / w->membrane.constants->steps;
  a.growth = bounded_impulse(handle_spring_impulse(k, fx_saturate(parting)));
  m->impulse[n] += a.spring + a.damper;
  meter_axis_of_handle(w, &a);
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

void step_handles_mark(fray_world *w) {
  FRAY_ASSERT(world_has_handles(w));
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    for (uint32_t n = 0; n < 3 && w->handles.constants[h].body != HANDLE_NONE; ++n)
      w->handles.motion[h].speed[n] = w->rigid.states[w->handles.constants[h].body].velocity[n];
}

void step_handles_pull(fray_world *w, const elastic_step *step, int32_t part) {
  FRAY_ASSERT(world_has_handles(w) && step->part > 0);
  for (uint32_t h = 0; h < FRAY_HANDS; ++h)
    if (w->handles.constants[h].body != HANDLE_NONE) pull_handle(w, h, step, part);
}

#endif
