/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/cortexm/systick.h"

#include "platform/bare/bare.h"

#define SYST_CSR (*(volatile uint32_t *)0xE000E010u)
#define SYST_RVR (*(volatile uint32_t *)0xE000E014u)
#define SYST_CVR (*(volatile uint32_t *)0xE000E018u)
enum { ENABLE = 1, TICKINT = 2, CORE_CLOCK = 4 };

static volatile uint32_t arrived;
static uint32_t taken;

void systick_handler(void) { ++arrived; }

void tick_begin(uint32_t clock_hz, uint32_t rate_hz) {
  arrived = 0;
  taken = 0;
  SYST_RVR = clock_hz / rate_hz - 1u;
  SYST_CVR = 0;
  SYST_CSR = ENABLE | TICKINT | CORE_CLOCK;
}

/* Masked while it looks, so that no tick can come between the look and the sleep: a pending
 * interrupt ends WFI whether it is masked or not. SYSTICK_SPIN is for emulators: under QEMU's
 * `-icount sleep=off` a periodic timer passes twice in every sleep. */
#ifdef SYSTICK_SPIN
#define SLEEP "nop"
#else
#define SLEEP "wfi"
#endif
int32_t tick_wait(void) {
  __asm__ volatile("cpsid i" : : : "memory");
  while (arrived == taken) {
    __asm__ volatile(SLEEP "\ncpsie i\nisb\ncpsid i" : : : "memory");
  }
  const uint32_t missed = arrived - taken - 1u;
  taken = arrived;
  __asm__ volatile("cpsie i" : : : "memory");
  return (int32_t)(missed < INT32_MAX ? missed : INT32_MAX);
}

/* Downwards: a tick begins at 0, then the counter is filled. `arrived` read twice tells of a tick
 * between the two readings. */
uint32_t tick_spent(void) {
  const uint32_t turn = SYST_RVR + 1u;
  uint32_t before, count;
  do {
    before = arrived;
    count = SYST_CVR;
  } while (before != arrived);
  return (before - taken) * turn + (count == 0 ? 0u : turn - count);
}
