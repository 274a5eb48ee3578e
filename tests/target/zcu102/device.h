/* SPDX-License-Identifier: Apache-2.0 */
/* A two-handed device on CAN 1: answers each SYNC with the poses and commands of its script, checks
 * what it feels, and drops its own force after 3 ms without a FORCE. It runs in the interrupt of
 * CAN 1, which comes after that of CAN 0, and in a timer of its own. */
#ifndef FRAY_TESTS_TARGET_ZCU102_DEVICE_H
#define FRAY_TESTS_TARGET_ZCU102_DEVICE_H

#include <stdint.h>

#include "rt/fray.h"

/* What goes wrong, by the number of the SYNC. */
typedef struct {
  const char *name;
  uint32_t ticks;       /* that the session lasts */
  uint32_t silent_from; /* 0: never; no pose for so many SYNCs */
  uint32_t silent_for;
  uint32_t flood_at;    /* 0: never; instead of its poses, DEVICE_FLOOD that no port takes */
  uint32_t off_from;    /* 0: never; a controller is off the bus for so long, */
  uint32_t off_us;      /* 0: until the program puts it back */
  uintptr_t off_base;   /* CAN 0, or CAN 1: nobody is there to acknowledge */
} device_plan;

enum { DEVICE_FLOOD = 80 }; /* more than a receive FIFO holds */

typedef struct {
  uint32_t syncs, forces;
  uint32_t bad;       /* FORCE with a wrong check, or SYNC with a wrong length */
  uint32_t gaps;      /* FORCE whose counter is not the next */
  uint32_t off_tick;  /* FORCE that consumed another pose than the newest before its SYNC */
  uint32_t zeroed;    /* times that it dropped its force */
  uint32_t zeroed_us; /* at most so long after the last FORCE */
  int16_t force[FRAY_HANDS][3];
} device_report;

extern device_report device_felt;

/* Its timer interrupts no later than this, in counts. */
void device_wake(uint64_t at);

/* Joins CAN 1 and begins its timer. `script[count]`: the answer to each SYNC; behind its end the
 * last poses stay. The world's instance is 0. */
void simulated_device_begin(const device_plan *plan, const fray_input *script, uint32_t count);

#endif
