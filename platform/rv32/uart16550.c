/* SPDX-License-Identifier: Apache-2.0 */
/* Console by a 16550, exit status by the test finisher of QEMU's virt board. */
#include "platform/platform.h"

#ifndef UART16550
#define UART16550 0x10000000u
#endif
#ifndef TEST_FINISHER
#define TEST_FINISHER 0x00100000u
#endif
enum { DATA = 0, LINE_STATUS = 5, SENDER_EMPTY = 0x20, FINISH_PASS = 0x5555, FINISH_FAIL = 0x3333 };

void platform_print(const char *text) {
  volatile uint8_t *uart = (volatile uint8_t *)UART16550;
  while (*text != 0) {
    while ((uart[LINE_STATUS] & SENDER_EMPTY) == 0) {
    }
    uart[DATA] = (uint8_t)*text++;
  }
}

_Noreturn void platform_exit(int status) {
  *(volatile uint32_t *)TEST_FINISHER =
      status == 0 ? (uint32_t)FINISH_PASS : (uint32_t)status << 16 | FINISH_FAIL;
  for (;;) {
  }
}
