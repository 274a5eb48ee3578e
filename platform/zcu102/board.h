/* SPDX-License-Identifier: Apache-2.0 */
/* The functions of platform.h on the ZCU102: one core, CAN 0, the generic timer. README.md has the
 * registers and tells where a tick's input ends. */
#ifndef FRAY_PLATFORM_ZCU102_BOARD_H
#define FRAY_PLATFORM_ZCU102_BOARD_H

#include <stdint.h>

#include "platform/zcu102/timer.h"

enum { BOARD_PRIORITY_CAN = 0x40, BOARD_PRIORITY_TIMER = 0x60, BOARD_PRIORITY_OTHER = 0x80 };

/* Counters saturate nowhere: they wrap after 2^32. */
typedef struct {
  timer_grid grid;
  uint32_t stopping;      /* the next platform_wait() returns -1 */
  uint32_t overflows;     /* times that the receive FIFO was found to have lost frames */
  uint32_t bus_offs;
  uint32_t sends_dropped; /* the transmit FIFO was full, or the frame is CAN FD */
  uint32_t late;          /* SYNCs that were confirmed after PLATFORM_CONFIRM_US */
  uint32_t unexpected;    /* interrupts that no driver enabled */
  uint32_t drained_most;  /* frames that one SYNC found in the receive FIFO */
} board;

extern board zcu102_board;

/* Joins the bus for the frames of one runtime, 0..7, and begins the grid. */
void board_open(uint32_t instance, uint32_t rate_hz);

/* Bytes of stack that were touched since the start, of how many. */
uint32_t board_stack_used(void);
uint32_t board_stack_bytes(void);

/* The program: begins here, its result is the exit status. */
int main(void);

/* Interrupts that the board has no use for; the program may define it. */
void board_other_interrupt(uint32_t id);

/* From start.S. A fault says its kind (the vector), ESR, ELR and FAR; exit status 99. */
_Noreturn void board_main(void);
_Noreturn void board_fault(uint64_t kind, uint64_t syndrome, uint64_t at, uint64_t address);
void board_interrupt(void);

#endif
