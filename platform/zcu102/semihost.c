/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/zcu102/semihost.h"

/* Operations of Arm's semihosting specification, chapter 7. */
enum { SYS_GET_CMDLINE = 0x15, SYS_EXIT = 0x18, ADP_STOPPED_APPLICATION_EXIT = 0x20026 };

static uint64_t semihost_call(uint64_t operation, const void *argument) {
  register uint64_t x0 __asm__("x0") = operation;
  register const void *x1 __asm__("x1") = argument;
  __asm__ volatile("hlt #0xF000" : "+r"(x0) : "r"(x1) : "memory");
  return x0;
}

void platform_exit(int status) {
  const uint64_t block[2] = {ADP_STOPPED_APPLICATION_EXIT, (uint64_t)status};
  (void)semihost_call(SYS_EXIT, block);
  for (;;) {
  }
}

void semihost_arguments(char *text, uint32_t bytes) {
  const struct {
    char *text;
    uint64_t bytes;
  } block = {text, bytes};
  text[0] = 0;
  if (semihost_call(SYS_GET_CMDLINE, &block) != 0) text[0] = 0;
  text[bytes - 1] = 0;
}
