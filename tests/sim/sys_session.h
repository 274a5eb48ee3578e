/* SPDX-License-Identifier: Apache-2.0 */
/* The loop of a small session under force, on the Linux board and a kernel in memory. */
#ifndef FRAY_TESTS_SIM_SYS_SESSION_H
#define FRAY_TESTS_SIM_SYS_SESSION_H

#include "platform/linux/board.h"
#include "tests/sim/sim_session.h"
#include "tests/sim/sys_faults.h"

enum { LOG_FD = 9 };

static fixture saved;
static bus_log own_log;
static loop l;

static void prepare(void) { session_under_force(&saved); }

/* A world anew from the one save, its board open; calls take so long. Returns 0 where the board does not open. */
static inline int sys_session_begin(int64_t call_ns) {
  fray_error error;
  fray_world *world;
  if (fray_open(saved.image, saved.image_bytes, saved.memory, saved.memory_bytes, &world, &error) != FRAY_OK)
    fixture_give_up("fray_open", error.what);
  const fray_info facts = fray_get_info(world);
  sys_begin();
  if (call_ns != 0) sys.call_ns = call_ns;
  sys.counter = facts.consumed[0];
  bus_log_begin(&own_log, LOG_FD);
  const int opened = board_open("sys0", 0, facts.rate_hz, 0, &own_log);
  loop_begin(&l, world, 0);
  return opened;
}

static inline int sys_session_end(void) {
  sys_end();
  fixture_close(&saved);
  return test_end();
}

#endif
