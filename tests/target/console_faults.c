/* SPDX-License-Identifier: Apache-2.0 */
/* A console that faults, linked with --wrap=platform_print: a fault must come to its exit all the same. */
#include "platform/platform.h"

void __wrap_platform_print(const char *text);
void __wrap_platform_print(const char *text) {
  (void)text;
  __builtin_trap();
}

int main(void) { __builtin_trap(); }
