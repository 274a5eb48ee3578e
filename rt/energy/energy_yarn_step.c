/* SPDX-License-Identifier: Apache-2.0 */
/* What damping and contact do in an elastic step of yarns. A body that holds stretched yarns back answers
 * their whole pull in every step, and neither is motion. So an impulse has the work of the step: itself times
 * the mean of the velocities before the step and behind all of its impulses. Those of all stages add up to
 * what the step changes, in any order; `steps` has the rest when the ledger measures next. */
#include "rt/energy/energy.h"
#include "rt/energy/energy_measure.h"

#if FRAY_ENERGY

static metered_yarn_body body_now(const fray_world *w, uint32_t b) {
  metered_yarn_body m;
  for (uint32_t n = 0; n < 3; ++n) {
    m.impulse[n] = w->rigid.motion[b].impulse[n];
    m.speed[n] = body_fine_speed(&w->rigid.states[b], n);
  }
  return m;
}

void energy_add_step_mark(fray_world *w, uint32_t mark) {
  FRAY_ASSERT(world_has_elastic_yarns(w) && mark < YARN_STEP_MARKS);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) w->energy.step[mark][b] = body_now(w, b);
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p)
    w->woven.metered[p].velocity[mark] = world_velocity(w, p);
}

static void book_stage(fray_world *w, fray_energy_stage stage, wide_number work) {
  energy_ledger_book(&w->energy, &w->energy.stage[stage], work);
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
  const vec3 *at = w->woven.metered[p].velocity;
  const int64_t mass = energy_mass(w, p);
  const vec3 v = world_velocity(w, p);
  const vec3 begun = at[YARN_STEP_BEGUN];
  const int64_t twice[3] = {(int64_t)begun.x + v.x + gravity.x, (int64_t)begun.y + v.y + gravity.y,
                            (int64_t)begun.z + v.z + gravity.z};
  if (!vec_is_equal(at[YARN_STEP_DAMPED], begun))
    book_stage(w, FRAY_ENERGY_DAMPING, work_of(mass, vec_sub(at[YARN_STEP_DAMPED], begun), twice));
  if (!vec_is_equal(v, at[YARN_STEP_FORCED]))
    book_stage(w, FRAY_ENERGY_CONTACT, work_of(mass, vec_sub(v, at[YARN_STEP_FORCED]), twice));
}

static void book_body_axis(fray_world *w, uint32_t b, uint32_t n, const metered_yarn_body *now,
                           int32_t gravity) {
  const rigid_body *k = &w->rigid.bodies[b];
  const metered_yarn_body *begun = &w->energy.step[YARN_STEP_BEGUN][b];
  const metered_yarn_body *forced = &w->energy.step[YARN_STEP_FORCED][b];
  const int64_t by_damping = w->energy.step[YARN_STEP_DAMPED][b].impulse[n] - begun->impulse[n];
  const int64_t by_contact = now->impulse[n] - forced->impulse[n];
  if (body_is_driven(k)) {
    const int32_t v = w->rigid.states[b].velocity[n];
    book_stage(w, FRAY_ENERGY_DAMPING, wide_product(-by_damping, v, 2u * FX_VELOCITY_BITS));
    book_stage(w, FRAY_ENERGY_CONTACT, wide_product(-by_contact, v, 2u * FX_VELOCITY_BITS));
    return;
  }
  const int64_t twice = begun->speed[n] + now->speed[n] + (int64_t)gravity * (1 << 16);
  book_stage(w, FRAY_ENERGY_DAMPING, body_fine_work(k, -fx_asr64(by_damping * k->mass_ratio, 14), twice));
  book_stage(w, FRAY_ENERGY_CONTACT, body_fine_work(k, now->speed[n] - forced->speed[n], twice));
}

void energy_book_step(fray_world *w, vec3 gravity) {
  const int32_t g[3] = {gravity.x, gravity.y, gravity.z};
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) book_particle(w, p, gravity);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    const metered_yarn_body now = body_now(w, b);
    for (uint32_t n = 0; n < 3; ++n) book_body_axis(w, b, n, &now, g[n]);
  }
}

#endif
