/* SPDX-License-Identifier: Apache-2.0 */
/* Exact decimals as text: 0.25, -981, 1e-3. */
#ifndef FRAY_TOOLS_SCENE_LANGUAGE_NUMBER_H
#define FRAY_TOOLS_SCENE_LANGUAGE_NUMBER_H

#include <stddef.h>

#include "tools/scene_language/exact.h"

enum { NUMBER_DIGITS = 18, NUMBER_EXPONENT = 18, NUMBER_TEXT = 28 };

typedef enum {
  NUMBER_GOOD,
  NUMBER_NONE,     /* no number */
  NUMBER_LONG,     /* more than NUMBER_DIGITS digits */
  NUMBER_EXTREME   /* an exponent beyond +-NUMBER_EXPONENT, or a value that overflows `exact` */
} number_status;

/* Reads the number at the start of the text; *used is its length, also of a bad one. */
number_status number_read(const char *text, size_t bytes, exact *value, size_t *used);

/* The value in decimals, rounded to 6 digits, a larger one to a whole number: way < 0 down, > 0 up, 0 to the
 * nearest. "?" iff it is invalid. Returns text. */
const char *number_write(exact value, int way, char text[NUMBER_TEXT]);

#endif
