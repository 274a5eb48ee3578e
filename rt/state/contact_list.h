/* SPDX-License-Identifier: Apache-2.0 */
/* Contacts of one tick: particles that may touch a body before the tick ends. */
#ifndef FRAY_STATE_CONTACT_LIST_H
#define FRAY_STATE_CONTACT_LIST_H

#include "rt/base/vec.h"

enum { CONTACT_APART, CONTACT_TOUCHES, CONTACT_GROUND /* the normal is (0, 1, 0) and is not stored */ };

typedef struct {
  uint32_t particle;
  uint16_t body;
  uint16_t touching; /* in this substep: CONTACT_APART, _TOUCHES or _GROUND */
  vec3 normal;       /* Q30, from the body to the particle; valid for CONTACT_TOUCHES */
} contact;

#endif
