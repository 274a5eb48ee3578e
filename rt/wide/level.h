/* SPDX-License-Identifier: Apache-2.0 */
/* What contacts with a plane that faces up take (lift.h): stage/collide.c says what is computed. */
#ifndef FRAY_WIDE_LEVEL_H
#define FRAY_WIDE_LEVEL_H

#include "rt/base/vec.h"
#include "rt/model/contacts.h"
#include "rt/model/rows.h"

/* Particles by axis: where they are, their speeds, where they were predicted. */
typedef struct {
  int32_t *at[3];
  const int32_t *speed[3], *predicted[3];
  contact *contacts;
  vec3 body_moved; /* in this substep */
  int32_t height, skin, friction;
  const uint8_t *couple; /* crossing -> fray_couple; NULL in worlds without yarns */
  const row_id *place;   /* particle -> crossing */
  int64_t pushed[3];  /* sums over what was taken: steps times half crossings */
  uint32_t held_back; /* 0 iff nothing was, at the edge of the world */
} level_view;

#endif
