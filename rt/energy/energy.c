/* SPDX-License-Identifier: Apache-2.0 */
/* The books: behind each stage the difference of the total goes into a row. */
#include "rt/energy/energy.h"

#include "rt/base/bytes.h"
#include "rt/energy/energy_measure.h"

#if FRAY_ENERGY

enum { UNIT_BITS = 40 };

static wide_number kinetic_of(const fray_world *w, const energy_stored *e) {
  wide_number sum = wide_add(e->motion, e->form);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) sum = wide_add(sum, e->held[b]);
  return sum;
}

static wide_number total_of(const fray_world *w, const energy_stored *e) {
  const wide_number moving = wide_add(wide_add(kinetic_of(w, e), e->bodies), e->potential);
  const wide_number coupled = wide_add(moving, e->handles);
  return wide_add(coupled, wide_add(wide_add(e->stretch, e->shear), wide_add(e->bend, e->yarns)));
}

static void book_body(fray_world *w, uint32_t b, wide_number work) {
  energy_ledger *l = &w->energy;
  const fray_energy_supply row =
      w->rigid.bodies[b].motion == FRAY_HAND ? FRAY_SUPPLIED_HANDS : FRAY_SUPPLIED_BODIES;
  energy_ledger_book(l, &l->supplied[row], work);
}

/* Impulses on the cloth since the last stage, times the velocities of their bodies. */
static void book_impulses(fray_world *w) {
  energy_ledger *l = &w->energy;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    const body_motion *m = &w->rigid.motion[b];
    for (uint32_t n = 0; n < 3; ++n) {
      const int64_t gained = m->impulse[n] - l->seen[b][n];
      l->seen[b][n] = m->impulse[n];
      if (gained != 0 && body_is_driven(&w->rigid.bodies[b]))
        book_body(w, b,
                  wide_product(gained, w->rigid.states[b].velocity[n], 2u * FX_VELOCITY_BITS));
    }
  }
}

/* What the total has changed by since the last stage, less what is in the books. */
static wide_number take_difference(fray_world *w, int elastic) {
  energy_ledger *l = &w->energy;
  if (elastic && world_has_membrane(w)) energy_measure_membrane(w, &l->last);
  if (elastic && !world_has_membrane(w)) energy_measure_woven(w, &l->last);
  energy_measure_motion(w, &l->last);
  book_impulses(w);
  const wide_number nothing = {0, 0};
  const wide_number before = l->total;
  l->total = total_of(w, &l->last);
  const wide_number rest = wide_sub(wide_sub(l->total, before), l->booked);
  l->booked = nothing;
  return rest;
}

/* The account begins with the first measure, in a membrane when its tick's constants are known. */
static int has_begun(fray_world *w) {
  energy_ledger *l = &w->energy;
  if (l->begun) return 1;
  (void)take_difference(w, 1);
  bytes_zero(l->supplied, sizeof l->supplied);
  l->begin = l->total;
  l->begin_potential = l->last.potential;
  l->begun = 1;
  return 0;
}

static void book(fray_world *w, fray_energy_stage stage, int elastic) {
  if (!has_begun(w)) return;
  w->energy.stage[stage] = wide_add(w->energy.stage[stage], take_difference(w, elastic));
}

/* No body touches cloth in this tick, and none is moved by it. */
static int has_no_contact(const fray_world *w) {
  if (w->contact.count != 0 || world_has_rigid_meshes(w)) return 0;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (w->rigid.bodies[b].motion == FRAY_FREE) return 0;
  return 1;
}

void energy_close_stage(fray_world *w, fray_energy_stage stage) {
  if (stage == FRAY_ENERGY_CONTACT && has_no_contact(w)) return;
  book(w, stage, 1);
}

void energy_close_wind(fray_world *w) {
  wide_number *wind = &w->energy.supplied[FRAY_SUPPLIED_WIND];
  if (w->membrane.constants->wind_normal == 0 && w->membrane.constants->wind_drag == 0) return;
  if (has_begun(w)) *wind = wide_add(*wind, take_difference(w, 1));
}

static void measure_all(fray_world *w) {
  energy_measure_woven(w, &w->energy.last);
  energy_measure_motion(w, &w->energy.last);
}

/* Sets it to the ledger's, and the ledger's to it. */
static void swap_velocity(fray_world *w, uint32_t b) {
  const vec3 now = vec_of(w->rigid.states[b].velocity);
  vec_store(w->rigid.states[b].velocity, vec_of(w->energy.velocity[b]));
  vec_store(w->energy.velocity[b], now);
}

static int has_new_velocity(const fray_world *w, uint32_t b) {
  return body_is_driven(&w->rigid.bodies[b]) &&
         !vec_is_equal(vec_of(w->rigid.states[b].velocity), vec_of(w->energy.velocity[b]));
}

/* Springs that have acted hold bodies where these would be by their velocities: what a new velocity of a
 * driven body changes, with those of the others as they are, is its work. */
static void book_leads(fray_world *w) {
  energy_ledger *l = &w->energy;
  uint32_t changed = 0; /* a bit each */
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) changed |= (uint32_t)has_new_velocity(w, b) << b;
  if (changed == 0) return;
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if ((changed >> b & 1u) != 0) swap_velocity(w, b);
  measure_all(w);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b) {
    if ((changed >> b & 1u) == 0) continue;
    const wide_number before = total_of(w, &l->last);
    swap_velocity(w, b);
    vec_store(l->velocity[b], vec_of(w->rigid.states[b].velocity));
    measure_all(w);
    book_body(w, b, wide_sub(total_of(w, &l->last), before));
  }
}

/* Yarns and membranes have not pulled yet. */
static void book_holds(fray_world *w) {
  energy_ledger *l = &w->energy;
  wide_number held[MAX_BODIES];
  bytes_copy(held, l->last.held, sizeof held);
  energy_measure_motion(w, &l->last);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    if (body_is_driven(&w->rigid.bodies[b])) book_body(w, b, wide_sub(l->last.held[b], held[b]));
}

void energy_close_bodies(fray_world *w) {
  if (!has_begun(w)) return;
  if (world_is_projected(w))
    book_leads(w);
  else
    book_holds(w);
  book(w, FRAY_ENERGY_STEPS, 0);
}

void energy_close_moves(fray_world *w) {
  w->energy.displaced = 1;
  if (!world_has_elastic_yarns(w)) w->energy.passed += 1;
  book(w, FRAY_ENERGY_STEPS, 1);
}

void energy_close_velocities(fray_world *w) {
  w->energy.displaced = 0;
  book(w, FRAY_ENERGY_LIMITS, 0);
}

void energy_add_slide(fray_world *w, vec3 by) {
  w->energy.slid = wide_add(w->energy.slid, energy_of_contact(w, by));
}

void energy_close_steps_of_slides(fray_world *w) {
  w->energy.booked = wide_add(w->energy.booked, w->energy.slid);
  book(w, FRAY_ENERGY_STEPS, 1);
}

void energy_close_slides(fray_world *w) {
  energy_ledger *l = &w->energy;
  const wide_number nothing = {0, 0};
  l->booked = wide_sub(l->booked, l->slid);
  l->slid = nothing;
  book(w, FRAY_ENERGY_SLIP, 1);
}

void energy_open_tick(fray_world *w) {
  energy_ledger *l = &w->energy;
  bytes_zero(l->seen, sizeof l->seen);
  bytes_zero(l->stage, sizeof l->stage);
  l->passed = world_has_membrane(w) ? 0 : energy_spring_moves(w);
  if (!world_has_membrane(w)) (void)has_begun(w);
  for (uint32_t b = 0; b < (uint32_t)w->params->bodies; ++b)
    vec_store(l->velocity[b], vec_of(w->rigid.states[b].velocity));
}

static void find_fastest(fray_world *w) {
  energy_ledger *l = &w->energy;
  for (uint32_t p = particles_attached(w); p < w->p.count; ++p) {
    const uint64_t squared = vec_squared(world_velocity(w, p));
    if (squared <= l->fastest_squared) continue;
    l->fastest_squared = squared;
    l->fastest_vertex = p;
    l->fastest_tick = state_tick(w->state);
  }
}

void energy_close_tick(fray_world *w) {
  energy_ledger *l = &w->energy;
  find_fastest(w);
  ++l->ticks;
  for (uint32_t n = 0; n < FRAY_ENERGY_STAGES; ++n) {
    if (wide_is_negative(l->stage[n]))
      l->lost[n] = wide_sub(l->lost[n], l->stage[n]);
    else
      l->made[n] = wide_add(l->made[n], l->stage[n]);
  }
}

void fray_energy_watch(fray_world *w) {
  FRAY_ASSERT(w != NULL);
  bytes_zero(&w->energy, sizeof w->energy);
  w->energy.watched = 1;
}

fray_energy_account fray_energy(const fray_world *w) {
  FRAY_ASSERT(w != NULL);
  const energy_ledger *l = &w->energy;
  const energy_stored *e = &l->last;
  const wide_number stored[FRAY_ENERGY_STORES] = {
      kinetic_of(w, e), e->bodies, e->stretch, e->shear, e->bend, e->yarns, e->handles, e->potential};
  fray_energy_account a;
  bytes_zero(&a, sizeof a);
  if (!l->begun) return a;
  a.ticks = l->ticks;
  a.begun = wide_rounded(l->begin, UNIT_BITS);
  a.gravity = wide_rounded(wide_sub(l->begin_potential, e->potential), UNIT_BITS);
  for (uint32_t n = 0; n < FRAY_ENERGY_STORES; ++n)
    a.stored[n] = wide_rounded(stored[n], UNIT_BITS);
  for (uint32_t n = 0; n < FRAY_ENERGY_SUPPLIES; ++n)
    a.supplied[n] = wide_rounded(l->supplied[n], UNIT_BITS);
  for (uint32_t n = 0; n < FRAY_ENERGY_STAGES; ++n) {
    a.made[n] = wide_rounded(l->made[n], UNIT_BITS);
    a.lost[n] = wide_rounded(l->lost[n], UNIT_BITS);
  }
  a.fastest_vertex = l->fastest_vertex;
  a.fastest_tick = l->fastest_tick;
  a.fastest_speed =
      l->fastest_squared != 0 ? fx_root_length(fx_rsqrt(l->fastest_squared, FX_ROOT_FINE)) : 0;
  return a;
}

#endif
