/* SPDX-License-Identifier: Apache-2.0 */
/* The tick by the machine timer of a RISC-V core-local interruptor. */
#include "platform/bare/bare.h"

#ifndef RV32_MTIMECMP
#define RV32_MTIMECMP 0x02004000u
#endif
#ifndef RV32_MTIME
#define RV32_MTIME 0x0200BFF8u
#endif
enum { MIE_MTIE = 1 << 7 };

static uint32_t turn;  /* counts of a tick */
static uint64_t began; /* count at which the current tick was due */

static volatile uint32_t *word(uint32_t address) { return (volatile uint32_t *)(uintptr_t)address; }

static uint64_t now(void) {
  uint32_t high, low;
  do {
    high = word(RV32_MTIME)[1];
    low = word(RV32_MTIME)[0];
  } while (high != word(RV32_MTIME)[1]);
  return (uint64_t)high << 32 | low;
}

/* The high word is out of reach while the low one changes: no interrupt from half a time. */
static void wake_at(uint64_t count) {
  word(RV32_MTIMECMP)[1] = UINT32_MAX;
  word(RV32_MTIMECMP)[0] = (uint32_t)count;
  word(RV32_MTIMECMP)[1] = (uint32_t)(count >> 32);
}

void tick_begin(uint32_t clock_hz, uint32_t rate_hz) {
  turn = clock_hz / rate_hz;
  began = now();
  wake_at(UINT64_MAX);
  __asm__ volatile("csrs mie, %0" : : "r"(MIE_MTIE));
}

/* The interrupt is enabled in mie and not in mstatus: it ends WFI and calls no handler. */
int32_t tick_wait(void) {
  const uint64_t behind = (now() - began) / turn;
  const uint32_t missed = behind > 1 ? (uint32_t)(behind - 1u) : 0u;
  began += (uint64_t)(missed + 1u) * turn;
  wake_at(began);
  while (now() < began) __asm__ volatile("wfi" : : : "memory");
  return (int32_t)missed;
}

uint32_t tick_spent(void) { return (uint32_t)(now() - began); }
