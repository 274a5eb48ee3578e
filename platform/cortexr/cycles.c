/* SPDX-License-Identifier: Apache-2.0 */
/* The tick by the cycle counter of the core, watched: a Cortex-R5 has no timer of its own. A board
 * with a timer sleeps instead. */
#include "platform/bare/bare.h"

enum { ENABLE = 1, RESET_CYCLES = 4 };

static uint32_t turn;  /* counts of a tick */
static uint32_t began; /* count at which the current tick was due */

static uint32_t cycles(void) {
  uint32_t count;
  __asm__ volatile("mrc p15, 0, %0, c9, c13, 0" : "=r"(count) : : "memory");
  return count;
}

void tick_begin(uint32_t clock_hz, uint32_t rate_hz) {
  __asm__ volatile("mcr p15, 0, %0, c9, c12, 0" : : "r"(ENABLE | RESET_CYCLES) : "memory");
  __asm__ volatile("mcr p15, 0, %0, c9, c12, 1" : : "r"(1u << 31) : "memory");
  turn = clock_hz / rate_hz;
  began = cycles();
}

/* The counter turns over: a tick may take half of its range, 2 s at 1 GHz. */
int32_t tick_wait(void) {
  const uint32_t behind = (cycles() - began) / turn;
  const uint32_t missed = behind > 1 ? behind - 1u : 0u;
  began += (missed + 1u) * turn;
  while (cycles() - began > UINT32_MAX / 2u) {
  }
  return (int32_t)missed;
}

uint32_t tick_spent(void) { return cycles() - began; }
