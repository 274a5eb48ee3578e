/* SPDX-License-Identifier: Apache-2.0 */
/* A world on a real CAN interface, at its rate. */
#ifndef FRAY_TOOLS_LIVE_H
#define FRAY_TOOLS_LIVE_H

#include <stdint.h>

#include "rt/fray.h"
#include "tools/bus_key.h"

typedef struct {
  const char *interface;
  const char *record; /* log of the bus, or NULL */
  uint32_t instance;
  uint32_t ticks;     /* 0: until SIGINT or SIGTERM */
  int realtime;       /* SCHED_FIFO, locked memory */
  uint32_t priority;  /* 1..99 */
  uint32_t cpu;       /* LIVE_ANY_CPU: not pinned */
  uint32_t workers;   /* 0: as many as are of use; they are pinned to the CPUs from `cpu` on */
  bus_key_options key;
} live_options;

enum { LIVE_ANY_CPU = 0xFFFF };

/* Runs until the ticks are done or a signal asks to stop: then STOP goes over the bus, forces
 * fade to zero, and the log is flushed. Prints what happened on the bus. Returns the exit code:
 * 0 good, 1 log or freshness could not be written, 2 interface or key cannot be used. */
int live_run(fray_world *world, const live_options *o, fray_output *last);

#endif
