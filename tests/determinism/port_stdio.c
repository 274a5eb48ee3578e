/* SPDX-License-Identifier: Apache-2.0 */
/* The port of a machine with an operating system. */
#include <stdio.h>

#include "tests/determinism/cases.h"

void port_print(const char *text) { fputs(text, stdout); }
