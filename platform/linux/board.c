/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE /* ppoll, in sys.h */

#include "platform/linux/board.h"

#include <string.h>

#include "platform/linux/sys.h"
#include "platform/log/candump.h"
#include "platform/platform.h"
#include "rt/wire/dictionary.h"

/* Waits of 100 us; more of them fit into PLATFORM_CONFIRM_US only when they return at once. The cap is
 * for a clock that stands still. */
enum { READS_PER_SYNC = 1024, WAITS_PER_SYNC = 4096, QUIET_US = 5000, WAITS_TO_CLOSE = 4096,
       PAUSE_US = 20000, PAUSES = 60 /* and more than a second, the longest tick */ };

board linux_board;

int board_open(const char *interface, uint32_t instance, uint32_t rate_hz, int fd, bus_log *log) {
  can_setting setting;
  memset(&linux_board, 0, sizeof linux_board);
  memset(&setting, 0, sizeof setting);
  for (uint32_t m = 0; m < MESSAGES; ++m)
    setting.ids[setting.count++] = (uint16_t)dictionary_id((dictionary_message)m, instance);
  setting.fd = 1;
  setting.sends_fd = fd;
  linux_board.log = log;
  linux_board.sync_id = dictionary_id(MESSAGE_SYNC, instance);
  if (!can_open(&linux_board.can, interface, &setting)) return 0;
  timer_begin(&linux_board.timer, rate_hz);
  return 1;
}

static void write_log(const frame *f, int64_t time_us) {
  char line[CANDUMP_TEXT];
  if (linux_board.log == NULL) return;
  const size_t bytes = candump_format(line, linux_board.can.name, time_us, f);
  bus_log_line(linux_board.log, line, bytes);
}

static int send_frame(const frame *f) {
  if (!can_send(&linux_board.can, f)) return 0;
  ++linux_board.unconfirmed;
  return 1;
}

static can_event receive(frame *f) {
  int64_t time_us;
  const can_event event = can_receive(&linux_board.can, f, &time_us);
  if (event == CAN_ECHO) {
    if (linux_board.unconfirmed > 0) --linux_board.unconfirmed;
    if (f->id != linux_board.sync_id && linux_board.outputs_awaited > 0) --linux_board.outputs_awaited;
  }
  if (event != CAN_NOTHING) write_log(f, time_us);
  return event;
}

void board_close(int64_t timeout_us) {
  frame f;
  const int64_t end_ns = timer_now_ns() + timeout_us * 1000;
  for (int waits = 0; waits < WAITS_TO_CLOSE && timer_now_ns() < end_ns;) {
    if (receive(&f) != CAN_NOTHING) continue;
    if (linux_board.unconfirmed == 0) break;
    (void)can_wait(&linux_board.can, QUIET_US);
    ++waits;
  }
  if (linux_board.log != NULL) bus_log_end(linux_board.log);
  can_close(&linux_board.can);
}

/* While the bus is lost there is no grid to keep, and a signal ends the wait for the next try at any rate. */
int32_t platform_wait(void) {
  for (int n = 0; n < PAUSES && linux_board.lost && !linux_board.stopping; ++n)
    if (!timer_sleep(&linux_board.timer, PAUSE_US)) break;
  return linux_board.lost && linux_board.stopping ? -1 : timer_wait(&linux_board.timer);
}

static int same_frame(const frame *a, const frame *b) {
  return a->id == b->id && a->length == b->length && memcmp(a->data, b->data, a->length) == 0;
}

/* Everything up to the echo of the SYNC. Frames behind the cap stay in the socket's buffer. The time
 * runs from the first try to send: a process that was not run before it has lost nothing. */
static platform_result confirm(const frame *sync, port *p) {
  int sent = send_frame(sync);
  const int64_t end_ns = timer_now_ns() + PLATFORM_CONFIRM_US * 1000;
  frame f;
  uint32_t reads = 0;
  uint32_t waits = 0;
  do {
    /* read before the look: a process that was not run for 2 ms still looks once more */
    const int late = timer_now_ns() >= end_ns;
    const can_event event = receive(&f);
    if (event == CAN_ECHO && same_frame(&f, sync)) return PLATFORM_SENT;
    if (event == CAN_RECEIVED) port_push(p, &f);
    if (event != CAN_NOTHING) {
      ++reads;
    } else if (late || linux_board.can.down || linux_board.can.bus_off) {
      return PLATFORM_LOST;
    } else {
      (void)can_wait(&linux_board.can, 100);
      ++waits;
    }
    if (!sent && !late) sent = send_frame(sync);
  } while (reads < READS_PER_SYNC && waits < WAITS_PER_SYNC);
  if (reads == READS_PER_SYNC) ++linux_board.reads_capped;
  return PLATFORM_LOST;
}

platform_result platform_sync(const frame *sync, port *p) {
  const platform_result result = confirm(sync, p);
  linux_board.lost = result != PLATFORM_SENT;
  if (result == PLATFORM_SENT) { /* echoes come in the order of the bus */
    linux_board.outputs_lost += linux_board.outputs_awaited;
    linux_board.outputs_awaited = 0;
  }
  return result;
}

platform_result platform_send(const frame *f) {
  if (send_frame(f)) {
    ++linux_board.outputs_awaited;
    return PLATFORM_SENT;
  }
  ++linux_board.sends_refused;
  return PLATFORM_LOST;
}
