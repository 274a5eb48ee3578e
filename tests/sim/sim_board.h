/* SPDX-License-Identifier: Apache-2.0 */
/* platform/platform.h in virtual time, with a bus in memory: linked before the library, its three
 * functions stand in for platform/linux/board.c. The loop sends on one side; a test says what other
 * nodes say, in one order that the log keeps. */
#ifndef FRAY_TESTS_SIM_SIM_BOARD_H
#define FRAY_TESTS_SIM_SIM_BOARD_H

#include <stddef.h>

#include "platform/loop.h"

typedef struct {
  frame f;
  int64_t time_us;
  uint8_t own;    /* the loop sent it */
  uint8_t failed; /* it did not get on the bus: not in the log of the bus */
} sim_entry;

typedef struct {
  int64_t now_us, period_us, grid_us; /* the grid's last tick */
  sim_entry *entries;                 /* in the order of the bus; with those that failed */
  size_t count, capacity;
  size_t taken;        /* entries that the loop has read */
  uint32_t sync_fails; /* so many SYNCs get no confirmation from now on */
  uint32_t sync_seen;  /* 1: these SYNCs are on the bus, only their confirmation is missing */
  uint32_t send_fails; /* so many sends are refused from now on */
  int stop;
} sim_board;

extern sim_board sim;

void sim_begin(uint32_t rate_hz);
void sim_end(void);

/* Another node's frame, now. */
void sim_inject(const frame *f);
void sim_pose(uint32_t hand, uint8_t counter, int16_t x, int16_t y, int16_t z);
void sim_command(uint8_t counter, uint8_t verb);

/* How many entries from `from` on have this id and come from the loop: on the bus, or if `failed` not. */
size_t sim_own(size_t from, uint32_t id, int failed);

/* The bus as `candump -L` writes it; free() it. */
char *sim_log(size_t *bytes);

#endif
