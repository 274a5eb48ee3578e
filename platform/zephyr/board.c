/* SPDX-License-Identifier: Apache-2.0 */
/* Frames come in through a filter callback, in the driver's interrupt or thread, into a ring of one
 * writer and one reader. The transmit callback of SYNC notes how far the ring was filled: what is
 * before that place is the input of the tick. */
#include "platform/zephyr/board.h"

#include <string.h>
#include <zephyr/drivers/can.h>
#include <zephyr/kernel.h>
#include <zephyr/sys/atomic.h>

#include "platform/platform.h"

enum { RING = 256 }; /* a power of two */

static struct {
  const struct device *can;
  struct k_sem confirmed;
  int64_t next_us;
  atomic_t stopped, written, level, result;
  uint32_t read;
  uint8_t unconfirmed; /* the driver has a SYNC without a confirmation */
  struct can_frame ring[RING];
} board;

static uint32_t filled(void) { return (uint32_t)atomic_get(&board.written); }

static void received(const struct device *device, struct can_frame *in, void *user) {
  (void)device;
  (void)user;
  const uint32_t at = filled();
  board.ring[at % RING] = *in;
  atomic_set(&board.written, (atomic_val_t)(at + 1u));
}

static void sync_done(const struct device *device, int error, void *user) {
  (void)device;
  (void)user;
  atomic_set(&board.level, (atomic_val_t)filled());
  atomic_set(&board.result, (atomic_val_t)error);
  k_sem_give(&board.confirmed);
}

static void nothing_to_do(const struct device *device, int error, void *user) {
  (void)device;
  (void)error;
  (void)user;
}

static int64_t now_us(void) { return (int64_t)k_ticks_to_us_floor64((uint64_t)k_uptime_ticks()); }

int board_begin(const struct device *can) {
  static const struct can_filter every = {.id = 0, .mask = 0, .flags = 0};
  memset(&board, 0, sizeof board);
  board.can = can;
  k_sem_init(&board.confirmed, 0, 1);
  const int filter = can_add_rx_filter(can, received, NULL, &every);
  if (filter < 0) return filter;
  board.next_us = now_us() + CONFIG_FRAY_TICK_US;
  return can_start(can);
}

void board_stop(void) { atomic_set(&board.stopped, 1); }

int32_t platform_wait(void) {
  if (atomic_get(&board.stopped) != 0) return -1;
  const int64_t left = board.next_us - now_us();
  if (left > 0) k_sleep(K_USEC(left));
  const int64_t late = now_us() - board.next_us;
  const int64_t missed = late > 0 ? late / CONFIG_FRAY_TICK_US : 0;
  board.next_us += (missed + 1) * CONFIG_FRAY_TICK_US;
  return missed < INT32_MAX ? (int32_t)missed : INT32_MAX;
}

static void hand_over(const struct can_frame *in, port *p) {
  frame f = {0};
  f.id = in->id;
  f.extended = (in->flags & CAN_FRAME_IDE) != 0;
  f.rtr = (in->flags & CAN_FRAME_RTR) != 0;
  f.length = can_dlc_to_bytes(in->dlc);
  if (f.length > FRAME_DATA_CLASSIC) f.length = FRAME_DATA_CLASSIC;
  if (f.rtr == 0) memcpy(f.data, in->data, f.length);
  port_push(p, &f);
}

/* After a lost bus the ring may be full, and frames still come in: the older half is left alone. */
static void take_until(uint32_t level, port *p) {
  if (level - board.read > RING / 2) board.read = level - RING / 2;
  for (; board.read != level; ++board.read) hand_over(&board.ring[board.read % RING], p);
}

static int send(const frame *f, can_tx_callback_t done) {
  struct can_frame out;
  if (f->fd != 0) return -1; /* sealed, for a board that has CAN FD */
  memset(&out, 0, sizeof out);
  out.id = f->id;
  out.dlc = can_bytes_to_dlc(f->length);
  memcpy(out.data, f->data, f->length);
  return can_send(board.can, &out, K_NO_WAIT, done, NULL);
}

/* A SYNC that the driver still holds is not sent twice; the call waits for its confirmation again. */
platform_result platform_sync(const frame *sync, port *p) {
  if (board.unconfirmed == 0 && send(sync, sync_done) != 0) return PLATFORM_LOST;
  board.unconfirmed = 1;
  if (k_sem_take(&board.confirmed, K_USEC(PLATFORM_CONFIRM_US)) != 0) return PLATFORM_LOST;
  board.unconfirmed = 0;
  if (atomic_get(&board.result) != 0) return PLATFORM_LOST;
  take_until((uint32_t)atomic_get(&board.level), p);
  return PLATFORM_SENT;
}

platform_result platform_send(const frame *f) {
  return send(f, nothing_to_do) == 0 ? PLATFORM_SENT : PLATFORM_LOST;
}
