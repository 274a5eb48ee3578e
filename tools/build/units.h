/* SPDX-License-Identifier: Apache-2.0 */
/* The units of a scene's text, by quantity. A value times its unit's factor is in the unit that
 * scene.h states. */
#ifndef FRAY_BUILD_UNITS_H
#define FRAY_BUILD_UNITS_H

#include <stddef.h>

#include "tools/build/exact.h"

typedef enum {
  UNIT_NONE, /* a plain number */
  UNIT_LENGTH,
  UNIT_TIME,
  UNIT_MASS,
  UNIT_FORCE,
  UNIT_FREQUENCY,
  UNIT_ACCELERATION,
  UNIT_SPEED,
  UNIT_AREAL_DENSITY,
  UNIT_STIFFNESS,
  UNIT_PER_LENGTH,
  UNIT_RATE,
  UNIT_FORCE_RATE,
  UNIT_SHARE, /* the unit may be left out: 0.05 is 5 % */
  UNIT_ANGLE,
  UNIT_BENDING
} unit_quantity;

/* Returns 1 iff the text is a unit of that quantity. */
int units_find(unit_quantity quantity, const char *text, size_t bytes, exact *factor);

/* What the quantity is called in a message. */
const char *units_quantity_name(unit_quantity quantity);

/* The unit that ranges are given in, "" for plain numbers; *factor as units_find. */
const char *units_of_range(unit_quantity quantity, exact *factor);

/* Appends the quantity's units to the text, separated by commas; cuts at capacity. */
void units_list(unit_quantity quantity, char *text, size_t capacity);

#endif
