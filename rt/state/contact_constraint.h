/* SPDX-License-Identifier: Apache-2.0 */
/* What a membrane may touch in a substep, as its elastic steps see it: a point of the cloth and a
 * plane that goes with a body. Of one substep, never state. See contact/constraint_solve.c. */
#ifndef FRAY_STATE_CONTACT_CONSTRAINT_H
#define FRAY_STATE_CONTACT_CONSTRAINT_H

#include "rt/base/vec.h"
#include "rt/fray.h"

enum {
  CONSTRAINTS_PER_CONTACT = 3, /* room in the pool, for each contact that has room */
  CONSTRAINT_ONE = 1 << 15     /* a whole weight */
};

/* How its plane follows the cloth within a substep. */
typedef enum {
  CONSTRAINT_FLAT,    /* it does not turn */
  CONSTRAINT_VERTEX,  /* of a curved primitive and one vertex: from shape.h in each step */
  CONSTRAINT_TRIANGLE /* of a sphere and a triangle: where that is nearest in each step */
} constraint_kind;

typedef struct {
  uint32_t vertex[3]; /* the unused ones are equal to the first */
  int32_t weight[3];  /* Q15, sum CONSTRAINT_ONE */
  vec3 normal;        /* Q30, out of the body */
  int32_t gap, low;   /* height of the point above the plane: Q28 lu, and 31 bits below it */
  int32_t mass;       /* effective mass of point and body, Q16 of a particle's mass */
  uint16_t body;
  uint16_t kind; /* constraint_kind */
} contact_constraint;

#endif
