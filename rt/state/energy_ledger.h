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

/* In an elastic step of yarns: before it, behind its damping, behind all but contact, behind that. */
typedef enum {
  ENERGY_STEP_BEGUN,
  ENERGY_STEP_DAMPED,
  ENERGY_STEP_FORCED,
  ENERGY_STEP_MARKS
} energy_step_mark_name;

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
  metered_yarn_body step[ENERGY_STEP_MARKS][MAX_BODIES]; /* of an elastic step of yarns, behind its marks */
  uint32_t fastest_vertex;
  uint64_t fastest_squared, fastest_tick;
} energy_ledger;
#endif

#endif
