/* SPDX-License-Identifier: Apache-2.0 */
/* Candidate contacts of one tick: particles that may reach a body before the tick ends. */
#ifndef FRAY_MODEL_CONTACTS_H
#define FRAY_MODEL_CONTACTS_H

#include "rt/base/vec.h"

enum { CONTACT_APART, CONTACT_TOUCHES, CONTACT_LEVEL /* its normal is (0, 1, 0) and stands nowhere */ };

typedef struct {
  uint32_t particle;
  uint16_t body;
  uint16_t touching; /* in this substep */
  vec3 normal;       /* Q30, from the body; valid for CONTACT_TOUCHES */
} contact;

#endif
