/* SPDX-License-Identifier: Apache-2.0 */
/* platform/platform.h on Linux: a SocketCAN interface, the monotonic clock, and a log of
 * everything that passes on the bus in the order in which this socket saw it. */
#ifndef FRAY_LINUX_BOARD_H
#define FRAY_LINUX_BOARD_H

#include "platform/linux/bus_log.h"
#include "platform/linux/can_socket.h"
#include "platform/linux/timer.h"

typedef struct {
  can_socket can;
  timer_grid timer;
  bus_log log;
  uint32_t sends_refused;
  uint32_t unconfirmed;    /* sent, and their echo has not come yet */
  uint32_t reads_capped;   /* ticks in which more came than is read at once */
  volatile int stopping;   /* set by a signal handler: platform_wait() returns -1 */
} board;

/* The one board of the process. */
extern board linux_board;

/* Opens interface and timer for one instance. `fd`: CAN FD frames will be sent, so the interface
 * must take them. `log_fd` is an open file or -1, and stays the caller's. Returns 1, or 0 after a
 * message to stderr. */
int board_open(const char *interface, uint32_t instance, uint32_t rate_hz, int fd, int log_fd);
/* Reads and logs until the echo of everything sent has come, at most `timeout_us`, then closes. */
void board_close(int64_t timeout_us);

#endif
