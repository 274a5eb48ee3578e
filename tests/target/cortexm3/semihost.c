/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/target/cortexm3/semihost.h"

#include <stddef.h>
#include <stdint.h>

#include "tests/cross/cases.h"

/* Operations of Arm's semihosting specification, chapter 7. */
enum { SYS_WRITE0 = 0x04, SYS_EXIT_EXTENDED = 0x20, ADP_STOPPED_APPLICATION_EXIT = 0x20026 };

static uint32_t semihost_call(uint32_t operation, const void *argument) {
  register uint32_t r0 __asm__("r0") = operation;
  register const void *r1 __asm__("r1") = argument;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

void semihost_print(const char *text) { (void)semihost_call(SYS_WRITE0, text); }

void semihost_exit(int code) {
  const uint32_t block[2] = {ADP_STOPPED_APPLICATION_EXIT, (uint32_t)code};
  (void)semihost_call(SYS_EXIT_EXTENDED, block);
  for (;;) {
  }
}

void port_print(const char *text) { semihost_print(text); }
