/* SPDX-License-Identifier: Apache-2.0 */
/* A tick of a membrane with self-collision, or beside meshes and spheres whose paths are tested, may be
 * attempted again (tick/tick_membrane.c): what it began with, and the impact zones that earlier attempts
 * have found. Of one tick, and in no other world. */
#ifndef FRAY_STATE_TICK_ATTEMPT_H
#define FRAY_STATE_TICK_ATTEMPT_H

#include "rt/state/bend_plate.h"
#include "rt/state/energy_ledger.h"
#include "rt/state/rigid_body.h"
#include "rt/state/spring.h"

enum { TICK_ATTEMPTS = 4 };

typedef struct {
  vec3 position;       /* Q24 lu */
  vec3 velocity;       /* Q28 lu per substep */
  index_t joined;      /* its zone; of self-collision a vertex towards the zone's root */
  int8_t remainder[3]; /* of its position, Q28 */
  uint8_t joined_body; /* 1 + the body that it was pinned to in earlier attempts, or 0 */
  uint8_t pinned;      /* 1: to a body, in this attempt */
  uint8_t pinned_to;   /* that body, if any */
} attempt_vertex;

typedef struct {
  body_state state;
  body_motion motion;
} attempt_body;

typedef struct {
  int32_t faults;
  int32_t gravity_phase[3];
  int32_t momentum_remainder[3];
  int32_t contact_tank[2];
  uint32_t joined_any, joined_new; /* there are zones before this attempt; it has found more */
  uint32_t constraints;            /* of self-contact */
#if FRAY_ENERGY
  energy_ledger energy;
#endif
} attempt_begin;

typedef struct {
  attempt_begin *begin;
  attempt_vertex *vertices;
  attempt_body *bodies;
  bend_state *bend_states; /* of a triangle */
  int32_t *owed;           /* by its stiffness */
} tick_attempt;

#endif
