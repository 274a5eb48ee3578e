/* SPDX-License-Identifier: Apache-2.0 */
/* A simulated two-handed device: an arm that follows a script and yields to forces.
 *
 * Each handle is a mass on the arm's spring and damper:  m x" = k (script - x) - b x' + F, within
 * the reach and the force of a small desktop device (a Falcon: 8 N, 4 cm, 1 kHz), or the arm of the
 * script. It zeroes its own force after 3 ms without a FORCE frame. Faults of its frames can be injected. */
#ifndef FRAY_TOOLS_BUS_SIMULATED_DEVICE_H
#define FRAY_TOOLS_BUS_SIMULATED_DEVICE_H

#include <stdint.h>

#include "rt/fray.h"
#include "rt/wire/frame.h"
#include "tools/bus/arm.h"
#include "tools/bus/script.h"

/* Injected faults, per thousand poses, and when. */
typedef struct {
  uint32_t drop, repeat, reorder, corrupt;
  uint32_t freeze_ms; /* no pose from this time on; 0: never */
  uint32_t jump_ms;   /* every pose at another corner from this time on; 0: never */
  uint32_t rigid;     /* 1: forces do not move it */
  uint32_t seed;
} device_faults;

typedef struct {
  double position[3], speed[3]; /* m, m/s */
  double force[3];           /* N */
  uint32_t silent_ticks;     /* without a FORCE */
  uint8_t counter;           /* of the last POSE */
  frame held_back;           /* a pose to be sent after the next one */
  int has_held_back;
  arm arm;                   /* where the script has one */
} simulated_handle;

enum { SIMULATED_DEVICE_FRAMES = 8 };

typedef struct {
  const script *script;
  device_faults faults;
  simulated_handle handle[FRAY_HANDS];
  uint32_t tick, draws, commands;
} simulated_device;

void simulated_device_begin(simulated_device *d, const script *s, const device_faults *faults);
/* A frame from the bus: FORCE is felt, others are ignored. */
void simulated_device_receive(simulated_device *d, const frame *f);
/* One tick of the device: its frames to send, at most SIMULATED_DEVICE_FRAMES. */
uint32_t simulated_device_step(simulated_device *d, frame frames[SIMULATED_DEVICE_FRAMES]);
int simulated_device_done(const simulated_device *d);

#endif
