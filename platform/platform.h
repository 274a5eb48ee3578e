/* SPDX-License-Identifier: Apache-2.0 */
/* What a board provides: five functions, found by the linker. The loop (platform/loop.c) calls the first
 * three; programs without an operating system call the other two.
 *
 * The input of tick k is what was received before the transmit confirmation of SYNC k; the board knows that
 * point: its own echo on Linux, the receive level latched in the transmit-complete interrupt on a
 * controller.
 *
 * Contract of all functions here. Context: the thread or interrupt level of the loop, one call at a time.
 * NULL: never. */
#ifndef FRAY_PLATFORM_PLATFORM_H
#define FRAY_PLATFORM_PLATFORM_H

#include <stdint.h>

#include "rt/wire/port.h"

#ifdef __cplusplus
#define PLATFORM_NORETURN [[noreturn]]
extern "C" {
#else
#define PLATFORM_NORETURN _Noreturn
#endif

enum { PLATFORM_CONFIRM_US = 2000 }; /* a SYNC that takes longer means the bus is lost */

typedef enum {
  PLATFORM_SENT,
  PLATFORM_LOST /* no confirmation in time, interface down, or bus-off */
} platform_result;

/* Waits for the next tick of a fixed grid and returns how many were missed: 0 when in time. Missed ticks
 * are not repeated. Returns -1 once the loop is asked to stop. Cost: a wait of one tick at most. */
int32_t platform_wait(void);

/* Sends a SYNC and pushes everything received before its confirmation to `p`, in order. After PLATFORM_LOST
 * the next call sends the same SYNC again. Cost: PLATFORM_CONFIRM_US at most. */
platform_result platform_sync(const frame *sync, port *p);

/* Queues a frame. PLATFORM_LOST: no room now; the loop keeps the frame and tries once more, in the next tick.
 * Cost: constant, without waiting. */
platform_result platform_send(const frame *f);

/* The console: text that ends with a 0. Figures and faults, never in a tick. Cost: linear in the text, at
 * the speed of a serial line. */
void platform_print(const char *text);

/* Ends the program. status: 0..125, the exit code of an emulator. A product restarts. Cost: it does not
 * return. */
PLATFORM_NORETURN void platform_exit(int status);

#ifdef __cplusplus
}
#endif
#endif
