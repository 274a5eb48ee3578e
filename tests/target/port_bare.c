/* SPDX-License-Identifier: Apache-2.0 */
/* The port of tests/determinism on a machine without an operating system. */
#include "platform/platform.h"
#include "tests/determinism/cases.h"

void port_print(const char *text) { platform_print(text); }
