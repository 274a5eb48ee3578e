/* SPDX-License-Identifier: Apache-2.0 */
/* The arguments of simd_ground_contact(). Arrays need the alignment of their elements, no more. */
#ifndef FRAY_SIMD_GROUND_CONTACT_VIEW_H
#define FRAY_SIMD_GROUND_CONTACT_VIEW_H

#include "rt/base/vec.h"
#include "rt/state/contact_list.h"
#include "rt/state/spring.h"

/* Arrays by axis x, y, z have one word for each particle. */
typedef struct {
  int32_t *at[3];              /* positions, Q24 lu, within +-FX_WORLD_MAX; written */
  const int32_t *speed[3];     /* Q28 lu per substep, within +-FX_SPEED_MAX */
  const int32_t *predicted[3]; /* at the begin of this step, Q24 lu */
  contact *contacts;           /* no two of a run have the same particle; `touching` is written */
  vec3 body_moved;             /* in this substep, Q24 lu */
  int32_t height, skin;        /* of the plane, and how far above it particles touch: Q24 lu */
  int32_t rise;                /* out of an overlap at most, Q24 lu, not negative */
  int32_t friction;            /* Q16, not negative */
  const uint8_t
      *crossing_state;        /* one for each crossing: fray_crossing_state; NULL in worlds without yarns */
  const index_t *crossing_of; /* one for each particle: its crossing; unused where crossing_state is NULL */
  int64_t pushed[3];          /* result, added up: position steps times half crossings */
  uint32_t held_back;         /* result, ORed: 0 iff no particle was held back at the edge of the world */
} ground_contact_view;

#endif
