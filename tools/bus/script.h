/* SPDX-License-Identifier: Apache-2.0 */
/* The script of a simulated pair of hands:
 *
 *   rate 1000 Hz          # poses a second and hand, default 1000
 *   seed 7                # of the noise, default 1
 *   noise 4 um            # uniform within +-4 um on each axis, default none
 *   instance 0            # which runtime on the bus, default 0
 *   duration 5 s
 *   arm 0.3 kg 500 N/m 2  # mass, stiffness, ticks of delay; default: a spring of 300 N/m
 *   command 0.1 s start   # start, stop, reset, zero or halt; at rising times
 *   left { 0 s 0 0 0 mm   1 s 0 0 0 mm   5 s -25 2 0 mm }
 *   right { 0 s 0 0 0 mm }
 *
 * A hand rests before its first keyframe and after its last, and moves between them along 3t^2-2t^3. All
 * in integers: one script gives the same log on every machine. */
#ifndef FRAY_TOOLS_BUS_SCRIPT_H
#define FRAY_TOOLS_BUS_SCRIPT_H

#include <stddef.h>
#include <stdint.h>

#include "platform/log/candump.h"
#include "rt/fray.h"

enum {
  SCRIPT_KEYFRAMES = 256,
  SCRIPT_COMMANDS = 64,
  SCRIPT_REACH_NM = 65000000,  /* of a keyframe: +-65 mm */
  SCRIPT_NOISE_NM_MAX = 500000 /* 0.5 mm: reach and noise fit int16 */
};

typedef struct {
  int64_t time_us;
  int32_t at_nm[3];
} script_keyframe;

typedef struct {
  int64_t time_us;
  fray_command verb;
} script_command;

typedef struct {
  uint32_t rate_hz, seed, instance;
  int32_t noise_nm;
  int64_t arm_mass_mg, arm_stiffness_un; /* un: uN/m; a mass of 0: no arm of its own */
  uint32_t arm_delay;                    /* ticks, see arm.h */
  int64_t duration_us;
  uint32_t keys[FRAY_HANDS]; /* 0: no such hand */
  script_keyframe key[FRAY_HANDS][SCRIPT_KEYFRAMES];
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

/* The pose of a hand with keyframes at the start of a tick; counter and buttons are 0. */
fray_pose script_pose(const script *s, uint32_t hand, uint32_t tick);

#endif
