/* SPDX-License-Identifier: Apache-2.0 */
/* A world on a real CAN interface, at its rate. */
#ifndef FRAY_TOOLS_BUS_LIVE_H
#define FRAY_TOOLS_BUS_LIVE_H

#include <stdint.h>

#include "rt/fray.h"
#include "tools/bus/bus_key.h"

typedef struct {
  const char *interface;
  const char *record; /* log of the bus, or NULL */
  uint32_t instance;
  uint32_t ticks;     /* 0: until a signal */
  int realtime;       /* SCHED_FIFO, locked memory */
  uint32_t priority;  /* 1..99 */
  uint32_t cpu;       /* LIVE_ANY_CPU: not pinned */
  uint32_t workers;   /* 0: as many as are useful; pinned to the CPUs from `cpu` on */
  bus_key_options key;
} live_options;

enum { LIVE_ANY_CPU = 0xFFFF };

/* How far START came. */
typedef enum { START_NONE, START_ACCEPTED, START_DONE } live_start;

static inline live_start live_start_seen(live_start before, const fray_output *o) {
  if (o->state == FRAY_OPERATIONAL) return START_DONE;
  const int accepted = o->answered == FRAY_COMMAND_START && o->result == FRAY_RESULT_OK;
  return before == START_NONE && accepted ? START_ACCEPTED : before;
}

typedef struct {
  fray_output last; /* of the last tick */
  live_start start;
} live_result;

/* Runs for all ticks or until a signal of signals.h, or the reader of a log that is a pipe ends: then
 * it sends STOP, forces fade to zero, a closing SYNC gives the last hash, and the log is written out. On a lost
 * bus that takes a second at most, or the rest of the tick in which the bus was lost. Prints statistics of the
 * bus. Returns the exit code:
 * 0 good, 1 log or freshness could not be written, 2 interface or key cannot be used. */
int live_run(fray_world *world, const live_options *o, live_result *result);

#endif
