/* SPDX-License-Identifier: Apache-2.0 */
/* Console and exit status of an Arm machine through its debugger or its emulator. Without one
 * attached the first call faults: a product has a UART (platform/rv32/uart16550.c is one). */
#include "platform/platform.h"

/* Operations of Arm's semihosting specification, chapter 7. */
enum { SYS_WRITE0 = 0x04, SYS_EXIT_EXTENDED = 0x20, ADP_STOPPED_APPLICATION_EXIT = 0x20026 };

static void semihost_call(uint32_t operation, const void *argument) {
  register uint32_t r0 __asm__("r0") = operation;
  register const void *r1 __asm__("r1") = argument;
#if __ARM_ARCH_PROFILE == 'M'
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
#else
  __asm__ volatile("svc %2" : "+r"(r0) : "r"(r1), "i"(0x123456) : "memory", "lr");
#endif
}

void platform_print(const char *text) { semihost_call(SYS_WRITE0, text); }

_Noreturn void platform_exit(int status) {
  const uint32_t block[2] = {ADP_STOPPED_APPLICATION_EXIT, (uint32_t)status};
  semihost_call(SYS_EXIT_EXTENDED, block);
  for (;;) {
  }
}
