/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/scene_language/units.h"

#include <stdio.h>
#include <string.h>

#include "tools/scene_language/nearest.h"

typedef struct {
  unit_quantity quantity;
  const char *name;
  int32_t numerator, denominator; /* of the factor */
  int of_range;
} unit;

static const unit table[] = {
    {UNIT_LENGTH, "um", 1, 10000, 0},
    {UNIT_LENGTH, "mm", 1, 10, 0},
    {UNIT_LENGTH, "cm", 1, 1, 1},
    {UNIT_LENGTH, "m", 100, 1, 0},
    {UNIT_TIME, "us", 1, 1000000, 0},
    {UNIT_TIME, "ms", 1, 1000, 0},
    {UNIT_TIME, "s", 1, 1, 1},
    {UNIT_MASS, "mg", 1, 1000, 0},
    {UNIT_MASS, "g", 1, 1, 1},
    {UNIT_MASS, "kg", 1000, 1, 0},
    {UNIT_FORCE, "mN", 1, 1000, 0},
    {UNIT_FORCE, "N", 1, 1, 1},
    {UNIT_FREQUENCY, "Hz", 1, 1, 1},
    {UNIT_FREQUENCY, "kHz", 1000, 1, 0},
    {UNIT_ACCELERATION, "cm/s2", 1, 1, 1},
    {UNIT_ACCELERATION, "m/s2", 100, 1, 0},
    {UNIT_SPEED, "mm/s", 1, 10, 0},
    {UNIT_SPEED, "cm/s", 1, 1, 1},
    {UNIT_SPEED, "m/s", 100, 1, 0},
    {UNIT_AREAL_DENSITY, "g/cm2", 1, 1, 1},
    {UNIT_AREAL_DENSITY, "g/m2", 1, 10000, 0},
    {UNIT_AREAL_DENSITY, "kg/m2", 1, 10, 0},
    {UNIT_STIFFNESS, "g/s2", 1, 1, 1},
    {UNIT_STIFFNESS, "N/m", 1000, 1, 0},
    {UNIT_STIFFNESS, "N/mm", 1000000, 1, 0},
    {UNIT_PER_LENGTH, "/cm", 1, 1, 1},
    {UNIT_PER_LENGTH, "/mm", 10, 1, 0},
    {UNIT_PER_LENGTH, "/m", 1, 100, 0},
    {UNIT_RATE, "/s", 1, 1, 1},
    {UNIT_FORCE_RATE, "N/s", 1, 1, 1},
    {UNIT_FORCE_RATE, "N/ms", 1000, 1, 0},
    {UNIT_FORCE_RATE, "mN/ms", 1, 1, 0},
    {UNIT_SHARE, "%", 1, 100, 1},
    {UNIT_ANGLE, "deg", 1, 1, 1},
    {UNIT_BENDING, "Nm", 1, 1, 1},
    {UNIT_BENDING, "mNm", 1, 1000, 0},
    {UNIT_BENDING, "uNm", 1, 1000000, 0},
    {UNIT_PRESSURE, "Pa", 1, 1, 1},
    {UNIT_PRESSURE, "kPa", 1000, 1, 0},
    {UNIT_PRESSURE, "MPa", 1000000, 1, 0},
    {UNIT_PRESSURE, "GPa", 1000000000, 1, 0},
    {UNIT_ENERGY, "J", 1, 1, 1},
    {UNIT_ENERGY, "mJ", 1, 1000, 0},
    {UNIT_ENERGY, "uJ", 1, 1000000, 0},
};

enum { UNITS = sizeof table / sizeof table[0] };

const char *units_find(unit_quantity quantity, const char *text, size_t bytes, exact *factor) {
  for (size_t k = 0; k < UNITS; k++) {
    const unit *u = &table[k];
    if (u->quantity != quantity || strlen(u->name) != bytes) continue;
    if (memcmp(u->name, text, bytes) != 0) continue;
    *factor = exact_make(u->numerator, u->denominator);
    return u->name;
  }
  return NULL;
}

const char *units_quantity_name(unit_quantity quantity) {
  switch (quantity) {
    case UNIT_NONE: return "plain number";
    case UNIT_LENGTH: return "length";
    case UNIT_TIME: return "time";
    case UNIT_MASS: return "mass";
    case UNIT_FORCE: return "force";
    case UNIT_FREQUENCY: return "frequency";
    case UNIT_ACCELERATION: return "acceleration";
    case UNIT_SPEED: return "speed";
    case UNIT_AREAL_DENSITY: return "areal density";
    case UNIT_STIFFNESS: return "stiffness";
    case UNIT_PER_LENGTH: return "count per length";
    case UNIT_RATE: return "rate";
    case UNIT_FORCE_RATE: return "force rate";
    case UNIT_SHARE: return "share";
    case UNIT_ANGLE: return "angle";
    case UNIT_BENDING: return "bending stiffness";
    case UNIT_PRESSURE: return "pressure";
    case UNIT_ENERGY: return "energy";
  }
  return "?";
}

const char *units_of_range(unit_quantity quantity, exact *factor) {
  for (size_t k = 0; k < UNITS; k++) {
    const unit *u = &table[k];
    if (u->quantity != quantity || !u->of_range) continue;
    *factor = exact_make(u->numerator, u->denominator);
    return u->name;
  }
  *factor = exact_make(1, 1);
  return "";
}

void units_list(unit_quantity quantity, char *text, size_t capacity) {
  const char *separator = "";
  for (size_t k = 0; k < UNITS; k++) {
    if (table[k].quantity != quantity) continue;
    size_t length = strlen(text);
    if (length + 1 >= capacity) return;
    snprintf(text + length, capacity - length, "%s%s", separator, table[k].name);
    separator = ", ";
  }
}

const char *units_near(unit_quantity quantity, const char *text, size_t bytes) {
  for (size_t k = 0; k < UNITS; k++)
    if (table[k].quantity == quantity && nearest_is_near(nearest_edits(text, bytes, table[k].name), bytes))
      return table[k].name;
  return NULL;
}
