/* SPDX-License-Identifier: Apache-2.0 */
/* What a simulated pair of hands does, as a text:
 *
 *   rate 1000 Hz          # poses a second and hand, default 1000
 *   seed 7                # of the noise, default 1
 *   noise 4 um            # evenly within +-4 um on each axis, default none
 *   instance 0            # which runtime on the bus, default 0
 *   duration 5 s
 *   command 0.1 s start   # start, stop, reset, zero or halt; in the order of time
 *   left { 0 s 0 0 0 mm   1 s 0 0 0 mm   5 s -25 2 0 mm }
 *   right { 0 s 0 0 0 mm }
 *
 * A hand rests before its first key and after its last, and goes from key to key along 3t^2-2t^3.
 * All numbers are integers below: one script gives one log on every machine. */
#ifndef FRAY_TOOLS_SCRIPT_H
#define FRAY_TOOLS_SCRIPT_H

#include <stddef.h>
#include <stdint.h>

#include "platform/log/candump.h"
#include "rt/fray.h"

enum {
  SCRIPT_KEYS = 256,
  SCRIPT_COMMANDS = 64,
  SCRIPT_REACH_NM = 65000000,  /* of a key: +-65 mm */
  SCRIPT_NOISE_NM_MAX = 500000 /* 0.5 mm: reach and noise fit int16 */
};

typedef struct {
  int64_t time_us;
  int32_t at_nm[3];
} script_key;

typedef struct {
  int64_t time_us;
  fray_verb verb;
} script_command;

typedef struct {
  uint32_t rate_hz, seed, instance;
  int32_t noise_nm;
  int64_t duration_us;
  uint32_t keys[FRAY_HANDS]; /* 0: this hand is not there */
  script_key key[FRAY_HANDS][SCRIPT_KEYS];
  uint32_t commands;
  script_command command[SCRIPT_COMMANDS];
} script;

/* Returns 1, or 0 with *error: file, line, column, what was expected. */
int script_parse(const char *file, const char *text, size_t bytes, script *out,
                 candump_error *error);

/* Number of ticks: those that begin before the duration is over. */
uint32_t script_ticks(const script *s);

/* First tick that begins at this time or later. */
uint32_t script_tick_at(const script *s, int64_t time_us);

/* The pose of a hand that is there, at the start of a tick; its counter and buttons are 0. */
fray_pose script_pose(const script *s, uint32_t hand, uint32_t tick);

#endif
