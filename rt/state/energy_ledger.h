/* SPDX-License-Identifier: Apache-2.0 */
/* What the energy ledger (rt/energy/) remembers; no part of the state: it is not hashed and not
 * saved.
 *
 * All energies are in masses of a particle times (lu per substep)^2. A stage that knows best what
 * it supplies or takes within its own loops adds that to `supplied` or `stage` itself; what else
 * changes the total is found between the stages. */
#ifndef FRAY_STATE_ENERGY_LEDGER_H
#define FRAY_STATE_ENERGY_LEDGER_H

#include "rt/base/vec.h"
#include "rt/base/wide.h"
#include "rt/fray.h"
#include "rt/state/params.h"
#include "rt/state/rigid_body.h"
#include "rt/state/yarn_elastic.h"

/* 1: with the ledger. Hosts have it; cores that do one thing at a time and machines without an
 * operating system do not, and neither code nor memory is left of it there. */
#ifndef FRAY_ENERGY
#if FX_NARROW || (defined(__STDC_HOSTED__) && __STDC_HOSTED__ == 0)
#define FRAY_ENERGY 0
#else
#define FRAY_ENERGY 1
#endif
#endif

#if FRAY_ENERGY
/* What is stored at one moment. The kinetic store is motion, form and held (rt/energy/README.md).
 */
typedef struct {
  wide_number motion, bodies, potential;
  wide_number stretch, shear, bend, yarns, handles;
  wide_number form; /* half of velocity times force, over the free particles */
  wide_number pull[MAX_BODIES]
                  [3];          /* the same of carried particles, but for their body's velocity */
  wide_number held[MAX_BODIES]; /* with it */
} energy_stored;

typedef struct {
  int watched;
  int begun;      /* `last` is known */
  int displaced;  /* positions are off their predictions, and velocities will follow */
  int32_t pulled; /* 1 between the pull of elastic yarns and the motion by it */
  int32_t passed; /* moves of particles since bend and shear springs acted */
  uint64_t ticks;
  energy_stored last; /* when the last stage ended */
  wide_number total;  /* the sum of its stores */
  wide_number begin;  /* the total when it began, and its potential */
  wide_number begin_potential;
  wide_number supplied[FRAY_ENERGY_SUPPLIES];
  wide_number booked;                    /* of this stage: what it has put into a row itself */
  wide_number slid;                      /* of slides of this pass: what the step before stored too much */
  wide_number stage[FRAY_ENERGY_STAGES]; /* of this tick, net */
  wide_number made[FRAY_ENERGY_STAGES], lost[FRAY_ENERGY_STAGES];
  int64_t seen[MAX_BODIES][3]; /* impulses of bodies that are in the books */
  int32_t velocity[MAX_BODIES][3]; /* of bodies, when a tick begins and when they moved last */
  metered_yarn_body step[YARN_STEP_MARKS][MAX_BODIES]; /* of an elastic step of yarns, behind its marks */
  uint32_t fastest_vertex;
  uint64_t fastest_squared, fastest_tick;
} energy_ledger;

/* Puts work that a stage knows into a row of the ledger. */
static inline void energy_ledger_book(energy_ledger *l, wide_number *row, wide_number work) {
  *row = wide_add(*row, work);
  l->booked = wide_add(l->booked, work);
}

/* Of a body with its fraction. */
enum { BODY_FINE_BITS = FX_VELOCITY_BITS + 16 };
static inline int64_t body_fine_speed(const body_state *s, uint32_t axis) {
  return (int64_t)s->velocity[axis] * (1 << 16) + ((uint32_t)s->fraction[axis] >> 14);
}
/* Of a free body, from a change of its speed by twice the mean, both Q44. */
static inline wide_number body_fine_work(const rigid_body *k, int64_t change, int64_t twice) {
  const int64_t mass = ((int64_t)1 << 50) / k->mass_ratio;
  return wide_times(wide_product(change, twice, 2 * BODY_FINE_BITS + 1), mass, 20);
}
#endif

#endif
