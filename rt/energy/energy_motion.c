/* SPDX-License-Identifier: Apache-2.0 */
/* Energy of motion and height. With m masses, v velocities, x positions and g the gravity of a
 * substep that is divided into n steps,
 *
 *   motion     sum of m v^2 / 2, of the free particles
 *   bodies     the same of free bodies; what they owe to the cloth counts as paid
 *   potential  - sum of m g.x, plus half of m g.v / n: a step first adds g / n to a velocity and
 * then moves, so v is half a step behind x, and a free fall keeps this sum to the last bit where g
 * is a whole number of velocity steps
 *
 * Sums are exact: squares of Q28 in 96 bits. */
#include "rt/energy/energy_measure.h"
#include "rt/state/crossing.h"

#if FRAY_ENERGY

int64_t energy_mass(const fray_world *w, uint32_t p) {
  FRAY_ASSERT(p < w->p.count);
  if (!world_has_membrane(w)) return (int64_t)particle_half_masses(w, p) << (ENERGY_MASS_BITS - 1);
  const int64_t unit = w->membrane.constants->mass_unit;
  return fx_clamp64((((int64_t)w->trimesh.mass[p] << ENERGY_MASS_BITS) + unit / 2) / unit, 0,
                    1 << 30);
}

/* Sums of m v^2, m v and m x: whole and part of 32 bits. */
typedef struct {
  wide_number squares;  /* Q28^2, masses */
  wide_number speed[3]; /* Q28, masses */
  wide_number at[3];
} motion_sums;

static void add_sum(wide_number *sum, int64_t v, unsigned bits) {
  *sum = wide_add(*sum, wide_of(v, bits));
}

static void add_particle(const fray_world *w, uint32_t p, motion_sums *s) {
  const int64_t mass = energy_mass(w, p);
  const vec3 v = energy_velocity(w, p);
  const int64_t squared = (int64_t)vec_squared(v);
  const int32_t speed[3] = {v.x, v.y, v.z};
  const int32_t at[3] = {w->p.x[p], w->p.y[p], w->p.z[p]};
  const int8_t rest[3] = {w->p.rx[p], w->p.ry[p], w->p.rz[p]};
  FRAY_ASSERT(mass >= 0 && mass <= 1 << 30); /* so that its products fit */
  add_sum(&s->squares, (squared >> 32) * mass, 2u * FX_VELOCITY_BITS + ENERGY_MASS_BITS - 32u);
  s->squares =
      wide_add(s->squares, wide_shift_down(wide_of((squared & UINT32_MAX) * mass, 63),
                                           2u * FX_VELOCITY_BITS + ENERGY_MASS_BITS - 63u));
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t q28 = (int64_t)at[n] * (1 << FX_SUB_BITS) + rest[n];
    add_sum(&s->speed[n], speed[n] * mass, FX_VELOCITY_BITS + ENERGY_MASS_BITS);
    s->at[n] = wide_add(s->at[n], wide_product(q28, mass, FX_VELOCITY_BITS + ENERGY_MASS_BITS));
  }
}

/* Gravity of a substep along an axis, Q60. */
static int64_t gravity_of(int32_t whole, int32_t rest) {
  return (int64_t)whole * ((int64_t)1 << 32) + (int64_t)(uint32_t)rest;
}

/* - g.x + g.v / 2n */
static void add_potential(const fray_world *w, const wide_number at[3], const wide_number speed[3],
                          uint32_t steps, energy_stored *e) {
  const params *k = w->params;
  const int64_t g[3] = {gravity_of(k->gravity_x, k->gravity_rest_x),
                        gravity_of(k->gravity_y, k->gravity_rest_y),
                        gravity_of(k->gravity_z, k->gravity_rest_z)};
  for (uint32_t n = 0; n < 3; ++n) {
    e->potential = wide_sub(e->potential, wide_times(at[n], g[n], 60));
    e->potential = wide_add(e->potential, wide_times(speed[n], g[n] / (int64_t)steps, 61));
  }
}

static uint32_t elastic_steps(const fray_world *w) {
  if (world_has_membrane(w)) return (uint32_t)w->membrane.constants->steps;
  return world_has_elastic_yarns(w) ? 1u << (uint32_t)w->woven.elastic_params->steps_bits : 1u;
}

/* The spring of a handle: k e (d - e / 2), where d is the way to its proxy and e what of it counts;
 * and half of velocity times its impulse, as of particles. It weighs nothing. Returns 1 iff the
 * body is one. */
static int add_handle(const fray_world *w, uint32_t b, energy_stored *e) {
#if FRAY_HANDLES
  const uint32_t h = (uint32_t)w->rigid.bodies[b].hand;
  if (!world_has_handles(w) || (uint32_t)w->handles.constants[h].body != b) return 0;
  const handle_params *k = &w->handles.constants[h];
  const handle_motion *m = &w->handles.motion[h];
  const body_state *s = &w->rigid.states[b];
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t q28 = (int64_t)s->position[n] * (1 << FX_SUB_BITS) + s->remainder[n];
    const int32_t extension = handle_extension(m->at[n], q28);
    const wide_number area = wide_sub(wide_product(extension, m->at[n] - q28, 2u * FX_VELOCITY_BITS),
                                      wide_product(extension, extension, 2u * FX_VELOCITY_BITS + 1u));
    const int64_t stiffness = (int64_t)k->spring * w->membrane.constants->steps;
    const wide_number form =
        wide_product(handle_spring_impulse(k, extension), s->velocity[n], 2u * FX_VELOCITY_BITS + 1u);
    e->handles = wide_add(e->handles, wide_times(area, stiffness, HANDLE_GAIN_BITS));
    e->bodies = wide_add(e->bodies, form);
  }
  return 1;
#else
  (void)w, (void)b, (void)e;
  return 0;
#endif
}

/* A free body, of 2^30 / mass_ratio masses; what cloth gained from it since its last substep is
 * taken off. */
static void add_body(const fray_world *w, uint32_t b, energy_stored *e) {
  enum { SPEED_BITS = FX_VELOCITY_BITS + 16 };
  const body_state *s = &w->rigid.states[b];
  const body_motion *m = &w->rigid.motion[b];
  const int64_t ratio = w->rigid.bodies[b].mass_ratio;
  const int64_t mass = ((int64_t)1 << 50) / ratio; /* Q20 */
  wide_number squares = {0, 0};
  wide_number at[3];
  wide_number speed[3];
  for (uint32_t n = 0; n < 3; ++n) {
    const int64_t owed =
        fx_clamp64(m->impulse[n] - m->applied[n], -((int64_t)1 << 32), (int64_t)1 << 32);
    const int64_t less = fx_asr64((int64_t)(uint32_t)s->fraction[n] - owed * ratio, 14);
    const int64_t v = (int64_t)s->velocity[n] * (1 << 16) + less;
    const int64_t q28 = (int64_t)s->position[n] * (1 << FX_SUB_BITS) + s->remainder[n];
    squares = wide_add(squares, wide_product(v, v, 2u * SPEED_BITS));
    speed[n] = wide_product(v, mass, SPEED_BITS + 20u);
    at[n] = wide_product(q28, mass, FX_VELOCITY_BITS + 20u);
  }
  e->bodies = wide_add(e->bodies, wide_shift_down(wide_times(squares, mass, 20), 1));
  if (add_handle(w, b, e)) return;
  add_potential(w, at, speed, elastic_steps(w), e);
}

static void measure_held(const fray_world *w, energy_stored *e) {
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    const wide_number nothing = {0, 0};
    e->held[b] = nothing;
    for (uint32_t n = 0; n < 3; ++n)
      e->held[b] = wide_add(
          e->held[b], wide_times(e->pull[b][n], w->rigid.states[b].velocity[n], FX_VELOCITY_BITS));
  }
}

void energy_measure_motion(const fray_world *w, energy_stored *e) {
  const wide_number nothing = {0, 0};
  motion_sums s = {nothing, {nothing, nothing, nothing}, {nothing, nothing, nothing}};
  e->bodies = e->handles = e->potential = nothing;
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) add_particle(w, p, &s);
  e->motion = wide_shift_down(s.squares, 1);
  add_potential(w, s.at, s.speed, elastic_steps(w), e);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->rigid.bodies[b].motion == FRAY_FREE && w->rigid.bodies[b].mass_ratio > 0)
      add_body(w, b, e);
  measure_held(w, e);
}

#endif
