/* SPDX-License-Identifier: Apache-2.0 */
/* What damping and contact do in an elastic step of yarns. A body that holds stretched yarns back answers
 * their whole pull in every step, and neither is motion. So an impulse has the work of the step: itself times
 * the mean of the velocities before the step and behind all of its impulses. Those of all stages add up to
 * what the step changes, in any order; `steps` has the rest when the ledger measures next. */
#include "rt/energy/energy.h"
#include "rt/energy/energy_measure.h"

#if FRAY_ENERGY

enum { FINE_BITS = FX_VELOCITY_BITS + 16 };

static void mark_body(fray_world *w, uint32_t b, metered_yarn_body *m) {
  const body_state *s = &w->rigid.states[b];
  for (uint32_t n = 0; n < 3; ++n) {
    m->impulse[n] = w->rigid.motion[b].impulse[n];
    m->speed[n] = (int64_t)s->velocity[n] * (1 << 16) + ((uint32_t)s->fraction[n] >> 14);
  }
}

void energy_add_step_mark(fray_world *w, uint32_t mark) {
  FRAY_ASSERT(world_has_elastic_yarns(w) && mark < ENERGY_STEP_MARKS);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) mark_body(w, b, &w->energy.step[mark][b]);
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    metered_yarn *m = &w->woven.metered[p];
    vec3 *const marks[ENERGY_STEP_MARKS] = {&m->begun, &m->damped, &m->forced};
    *marks[mark] = world_velocity(w, p);
  }
}

static void add_work(fray_world *w, fray_energy_stage stage, wide_number work) {
  w->energy.stage[stage] = wide_add(w->energy.stage[stage], work);
  w->energy.booked = wide_add(w->energy.booked, work);
}

/* Twice the mean of the velocities is `twice`. */
static wide_number work_of(int64_t mass, vec3 change, const int64_t twice[3]) {
  enum { BITS = 2 * FX_VELOCITY_BITS + ENERGY_MASS_BITS + 1 };
  const int64_t by[3] = {change.x, change.y, change.z};
  wide_number sum = {0, 0};
  for (uint32_t n = 0; n < 3; ++n)
    sum = wide_add(sum, wide_product(by[n] * mass, twice[n], BITS));
  return sum;
}

static void book_particle(fray_world *w, uint32_t p, vec3 gravity) {
  const metered_yarn *m = &w->woven.metered[p];
  const int64_t mass = energy_mass(w, p);
  const vec3 v = world_velocity(w, p);
  const int64_t twice[3] = {(int64_t)m->begun.x + v.x + gravity.x, (int64_t)m->begun.y + v.y + gravity.y,
                            (int64_t)m->begun.z + v.z + gravity.z};
  if (!vec_is_equal(m->damped, m->begun))
    add_work(w, FRAY_ENERGY_DAMPING, work_of(mass, vec_sub(m->damped, m->begun), twice));
  if (!vec_is_equal(v, m->forced))
    add_work(w, FRAY_ENERGY_CONTACT, work_of(mass, vec_sub(v, m->forced), twice));
}

/* Of a free body, from a change of its speed by twice the mean, both Q44. */
static wide_number free_work(const fray_world *w, uint32_t b, int64_t change, int64_t twice) {
  const int64_t mass = ((int64_t)1 << 50) / w->rigid.bodies[b].mass_ratio;
  return wide_times(wide_product(change, twice, 2 * FINE_BITS + 1), mass, 20);
}

static void book_body_axis(fray_world *w, uint32_t b, uint32_t n, int32_t gravity) {
  const metered_yarn_body *begun = &w->energy.step[ENERGY_STEP_BEGUN][b];
  const metered_yarn_body *damped = &w->energy.step[ENERGY_STEP_DAMPED][b];
  const metered_yarn_body *forced = &w->energy.step[ENERGY_STEP_FORCED][b];
  metered_yarn_body now;
  mark_body(w, b, &now);
  const int64_t by_damping = damped->impulse[n] - begun->impulse[n];
  const int64_t by_contact = now.impulse[n] - forced->impulse[n];
  if (body_is_driven(&w->rigid.bodies[b])) {
    const int32_t v = w->rigid.states[b].velocity[n];
    add_work(w, FRAY_ENERGY_DAMPING, wide_product(-by_damping, v, 2u * FX_VELOCITY_BITS));
    add_work(w, FRAY_ENERGY_CONTACT, wide_product(-by_contact, v, 2u * FX_VELOCITY_BITS));
    return;
  }
  const int64_t twice = begun->speed[n] + now.speed[n] + (int64_t)gravity * (1 << 16);
  const int64_t damping = -fx_asr64(by_damping * w->rigid.bodies[b].mass_ratio, 14);
  add_work(w, FRAY_ENERGY_DAMPING, free_work(w, b, damping, twice));
  add_work(w, FRAY_ENERGY_CONTACT, free_work(w, b, now.speed[n] - forced->speed[n], twice));
}

void energy_book_step(fray_world *w, vec3 gravity) {
  const int32_t g[3] = {gravity.x, gravity.y, gravity.z};
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) book_particle(w, p, gravity);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    for (uint32_t n = 0; n < 3; ++n) book_body_axis(w, b, n, g[n]);
}

#endif
