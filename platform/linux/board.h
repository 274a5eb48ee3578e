/* SPDX-License-Identifier: Apache-2.0 */
/* platform/platform.h on Linux: a SocketCAN interface, the monotonic clock, and a log of
 * everything on the bus, in the order in which this socket received it. */
#ifndef FRAY_PLATFORM_LINUX_BOARD_H
#define FRAY_PLATFORM_LINUX_BOARD_H

#include "platform/linux/bus_log.h"
#include "platform/linux/can_socket.h"
#include "platform/linux/timer.h"

typedef struct {
  can_socket can;
  timer_grid timer;
  bus_log *log;            /* the caller's, or NULL */
  uint64_t sends_refused;
  uint32_t unconfirmed;    /* sent, without an echo so far */
  uint32_t sync_id;
  uint32_t outputs_awaited; /* of these, all but SYNCs */
  uint64_t outputs_lost;   /* a later SYNC came back, they did not: an interface that goes takes what it has */
  uint64_t reads_capped;   /* ticks with more frames than are read at once */
  int lost;                /* the last SYNC had no echo */
  volatile int stopping;   /* set by a signal handler: while the bus is lost, platform_wait() returns -1 */
} board;

/* The one board of the process. */
extern board linux_board;

/* Opens interface and timer for one instance. `fd`: CAN FD frames will be sent, so the interface
 * must take them. `log` has begun, ends with board_close() and stays the caller's; NULL: none. Returns 1, or 0
 * after a message to stderr. */
int board_open(const char *interface, uint32_t instance, uint32_t rate_hz, int fd, bus_log *log);
/* Reads and logs until the echo of everything sent has come, at most `timeout_us`, then closes. */
void board_close(int64_t timeout_us);

#endif
