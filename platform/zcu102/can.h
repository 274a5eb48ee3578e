/* SPDX-License-Identifier: Apache-2.0 */
/* One CAN controller of the Zynq UltraScale+ (UG1085, chapter 20): classic CAN at 1 Mbit/s from a
 * reference clock of 100 MHz. The controller is named by its base address and has no other state
 * here. Not for two interrupt levels at a time. */
#ifndef FRAY_PLATFORM_ZCU102_CAN_H
#define FRAY_PLATFORM_ZCU102_CAN_H

#include <stdint.h>

#include "rt/wire/frame.h"

#define CAN0_BASE ((uintptr_t)0xFF060000u)
#define CAN1_BASE ((uintptr_t)0xFF070000u)

enum { CAN_FIFO = 64, CAN_FILTERS = 4 }; /* messages; ids to let through */

/* Bits of ISR, IER and ICR. */
enum {
  CAN_ARBLST = 1 << 0,
  CAN_TXOK = 1 << 1,    /* a frame of ours was sent and acknowledged */
  CAN_TXFLL = 1 << 2,
  CAN_TXBFLL = 1 << 3,
  CAN_RXOK = 1 << 4,
  CAN_RXUFLW = 1 << 5,
  CAN_RXOFLW = 1 << 6,  /* a frame came while the receive FIFO was full: it is lost */
  CAN_RXNEMP = 1 << 7,
  CAN_ERROR = 1 << 8,
  CAN_BSOFF = 1 << 9
};

/* A message as a FIFO holds it. */
typedef struct {
  uint32_t id, dlc, data1, data2;
} can_message;

/* Resets the controller and joins the bus. `ids`: 11-bit ids to receive, at most CAN_FILTERS;
 * none: all. `events`: what interrupts. */
void can_begin(uintptr_t base, const uint32_t *ids, uint32_t count, uint32_t events);

/* Joins or leaves the bus; frames in the FIFOs stay. */
void can_join(uintptr_t base);
void can_leave(uintptr_t base);

/* Which of `events` have come; they are cleared. */
uint32_t can_take_events(uintptr_t base, uint32_t events);

/* Adds to the transmit FIFO. Returns 0 iff it is full. */
int can_send(uintptr_t base, const frame *f);

/* Writes the high-priority buffer, which must be empty: it is sent before the FIFO. */
void can_send_first(uintptr_t base, const frame *f);
int can_first_waits(uintptr_t base);

/* Reads the oldest received message. Returns 0 iff there is none. */
int can_receive(uintptr_t base, can_message *m);
void can_to_frame(const can_message *m, frame *f);

#endif
