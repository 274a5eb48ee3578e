/* SPDX-License-Identifier: Apache-2.0 */
/* Exact decimals as text: 0.25, -981, 1e-3. */
#ifndef FRAY_BUILD_NUMBER_H
#define FRAY_BUILD_NUMBER_H

#include <stddef.h>

#include "tools/build/exact.h"

enum { NUMBER_DIGITS = 18, NUMBER_EXPONENT = 18 };

typedef enum {
  NUMBER_GOOD,
  NUMBER_NONE,     /* no number stands there */
  NUMBER_LONG,     /* more than NUMBER_DIGITS digits */
  NUMBER_EXTREME   /* an exponent beyond +-NUMBER_EXPONENT, or a value that is not exact here */
} number_status;

/* Reads the number that the text begins with; *used is its length, also of a bad one. */
number_status number_read(const char *text, size_t bytes, exact *value, size_t *used);

#endif
