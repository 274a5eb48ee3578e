/* SPDX-License-Identifier: Apache-2.0 */
/* What a board gives: five functions, found by the linker. The loop (platform/loop.c) calls the
 * first three. Programs without an operating system call the other two.
 *
 * The input of tick k is what was received before the transmit confirmation of SYNC k; the board
 * knows where that is: the own echo on Linux, the receive level latched in the transmit-complete
 * interrupt on a controller. */
#ifndef FRAY_PLATFORM_H
#define FRAY_PLATFORM_H

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

/* Waits for the next tick of a fixed grid and returns how many were missed: 0 when in time.
 * Missed ticks are not caught up. Returns -1 once the loop is asked to stop. */
int32_t platform_wait(void);

/* Sends a SYNC and gives `p` everything received before its confirmation, in order.
 * Bounded in time by PLATFORM_CONFIRM_US. A SYNC that was lost is sent again unchanged by the
 * next call. */
platform_result platform_sync(const frame *sync, port *p);

/* Queues a frame. PLATFORM_LOST: not now. The loop keeps it and tries once more, in the next tick. */
platform_result platform_send(const frame *f);

/* The console: text that ends with a 0. Figures and faults, never in a tick. */
void platform_print(const char *text);

/* Ends the program; `status` 0..125 is what an emulator exits with. A product starts again. */
PLATFORM_NORETURN void platform_exit(int status);

#ifdef __cplusplus
}
#endif
#endif
