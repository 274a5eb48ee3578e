/* SPDX-License-Identifier: Apache-2.0 */
/* The units of a scene, by quantity. A value times the factor of its unit is in the unit of scene.h. */
#ifndef FRAY_TOOLS_SCENE_LANGUAGE_UNITS_H
#define FRAY_TOOLS_SCENE_LANGUAGE_UNITS_H

#include <stddef.h>

#include "tools/scene_language/exact.h"

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
  UNIT_BENDING,
  UNIT_PRESSURE,
  UNIT_ENERGY
} unit_quantity;

/* The name of the unit of that quantity that the text is; NULL: none. */
const char *units_find(unit_quantity quantity, const char *text, size_t bytes, exact *factor);

/* Its name in messages. */
const char *units_quantity_name(unit_quantity quantity);

/* The unit of ranges, "" for plain numbers; *factor as in units_find(). */
const char *units_of_range(unit_quantity quantity, exact *factor);

/* Appends the quantity's units to the text, separated by commas; cuts at capacity. */
void units_list(unit_quantity quantity, char *text, size_t capacity);

/* The unit of the quantity that the text may be meant for, NULL: none. */
const char *units_near(unit_quantity quantity, const char *text, size_t bytes);

#endif
