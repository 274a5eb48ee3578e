/* SPDX-License-Identifier: Apache-2.0 */
/* A machine without an operating system: its start-up code, its tick and its stack.
 * The linker script (linker/) names the memory. */
#ifndef FRAY_PLATFORM_BARE_BARE_H
#define FRAY_PLATFORM_BARE_BARE_H

#include <stdint.h>

/* The end of every start-up: paints the stack, fills the data, runs main, gives its status to
 * platform_exit(). Interrupts are as the reset left them. */
_Noreturn void bare_start(void);

/* The end of every fault: prints the machine's number of it and how far the stack was used, then
 * platform_exit(). The stack has been set to its top before: this works after an overflow too. A
 * fault while it prints goes to platform_exit() at once, one in platform_exit() stops there; a
 * Cortex-M locks up at either. */
_Noreturn void bare_fault(uint32_t cause);
enum { BARE_FAULT_STATUS = 99 };

/* In decimal, by platform_print(). */
void bare_print_number(uint32_t value);

/* Bytes of the stack: all of it, and the deepest that was ever used. */
uint32_t bare_stack_bytes(void);
uint32_t bare_stack_used(void);

/* The tick: a fixed grid of `rate_hz` from a clock of `clock_hz`, begun once.
 * The clock has 1,000 counts a tick at least and, for SysTick, 2^24 at most. */
void tick_begin(uint32_t clock_hz, uint32_t rate_hz);

/* Sleeps until the next tick of the grid, or returns at once if it has passed. Returns the number of ticks
 * that were missed since the last call; they are not repeated. */
int32_t tick_wait(void);

/* Counts of the clock since the due time of the current tick; for figures only. */
uint32_t tick_spent(void);

/* For a loop that must stay a loop: compilers make calls of memcpy and memset of such loops. */
#ifdef __clang__
#define BARE_LOOP __attribute__((no_builtin))
#else
#define BARE_LOOP __attribute__((optimize("no-tree-loop-distribute-patterns")))
#endif

#endif
