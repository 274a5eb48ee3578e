/* SPDX-License-Identifier: Apache-2.0 */
/* Semihosting: text out and an exit status, through the debugger or the emulator. */
#ifndef FRAY_TARGET_SEMIHOST_H
#define FRAY_TARGET_SEMIHOST_H

void semihost_print(const char *text);
_Noreturn void semihost_exit(int code);

#endif
