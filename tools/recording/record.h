/* SPDX-License-Identifier: Apache-2.0 */
/* Writes a run as a log of the bus that `fray verify` can check.
 *
 * First, and before a tick whose low 32 bits are 0, IDENTITY. Per tick k: its POSE and COMMAND frames, with
 * their counters; SYNC k with the hash before it; then its FORCE, ACK, TEAR and STATUS. A closing SYNC
 * carries the last hash.
 * Times are artificial, 1000000000.000000 s + k / rate rounded up to a microsecond: no clock is read, so
 * one run gives one log. The interface is vcan0. */
#ifndef FRAY_TOOLS_RECORDING_RECORD_H
#define FRAY_TOOLS_RECORDING_RECORD_H

#include <stdint.h>
#include <stdio.h>

#include "rt/wire/port.h"

#define RECORD_EPOCH_US INT64_C(1000000000000000)
#define RECORD_INTERFACE "vcan0"

typedef struct {
  FILE *out;
  uint32_t rate_hz;
  uint64_t first, ticks;         /* number of the first tick; ticks written */
  uint32_t hash;                 /* low 32 bits after the last tick */
  uint8_t consumed[FRAY_HANDS];
  uint8_t started;               /* a tick was written: consumed is known */
  uint8_t failed;
  port_sender sender;            /* the caller may set contacts_max and overruns */
} record;

/* Time of a tick in a log with artificial times. */
int64_t record_time_us(uint64_t tick, uint32_t rate_hz);

/* `tick` and `hash`: of the world before the first fray_tick() (fray_get_info(), fray_hash()).
 * `hands`: bit h iff a body follows hand h. The caller closes the stream. */
void record_begin(record *r, FILE *out, uint32_t instance, uint32_t hands, uint32_t rate_hz,
                  uint64_t tick, uint64_t hash);

/* One tick. Returns 0 iff writing failed, or a log could not show the input: a pose with the counter of the
 * pose consumed before (a port never delivers one). */
int record_tick(record *r, const fray_input *input, const fray_output *output);

/* The closing SYNC. Returns 0 iff writing failed. */
int record_end(record *r);

#endif
