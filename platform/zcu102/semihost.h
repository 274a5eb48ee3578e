/* SPDX-License-Identifier: Apache-2.0 */
/* Semihosting: an exit status, and the words that the program was started with, through the
 * emulator or the debugger. Without one of them the core stops at a fault. */
#ifndef FRAY_PLATFORM_ZCU102_SEMIHOST_H
#define FRAY_PLATFORM_ZCU102_SEMIHOST_H

#include <stdint.h>

_Noreturn void platform_exit(int status);

/* Writes at most bytes - 1 characters and a 0; an empty text iff there are none. */
void semihost_arguments(char *text, uint32_t bytes);

#endif
