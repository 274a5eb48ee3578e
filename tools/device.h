/* SPDX-License-Identifier: Apache-2.0 */
/* A simulated two-handed device: a human arm that follows a script, and that forces push.
 *
 * Each handle is a mass on the arm's spring and damper:  m x" = k (script - x) - b x' + F, within
 * the reach and the force of a small desktop device (a Falcon: 8 N, 4 cm, 1 kHz). It zeroes its own
 * force after 3 ms without a FORCE frame. What it sends can be made to go wrong on request. */
#ifndef FRAY_TOOLS_DEVICE_H
#define FRAY_TOOLS_DEVICE_H

#include <stdint.h>

#include "rt/fray.h"
#include "rt/wire/frame.h"
#include "tools/script.h"

/* What goes wrong, in parts per thousand of the poses, and when. */
typedef struct {
  uint32_t drop, repeat, reorder, corrupt;
  uint32_t freeze_ms; /* from then on no pose; 0: never */
  uint32_t jump_ms;   /* from then on every pose is at another corner; 0: never */
  uint32_t rigid;     /* 1: forces do not move it */
  uint32_t seed;
} device_trouble;

typedef struct {
  double place[3], speed[3]; /* m, m/s */
  double force[3];           /* N */
  uint32_t silent_ticks;     /* without a FORCE */
  uint8_t counter;           /* of the last POSE */
  frame held_back;           /* a pose to be sent after the next one */
  int has_held_back;
} device_handle;

enum { DEVICE_FRAMES = 8 };

typedef struct {
  const script *script;
  device_trouble trouble;
  device_handle handle[FRAY_HANDS];
  uint32_t tick, draws, commands;
} device;

void device_begin(device *d, const script *s, const device_trouble *trouble);
/* A frame from the bus: FORCE is felt, others are ignored. */
void device_feel(device *d, const frame *f);
/* One tick of the device: its frames to send, at most DEVICE_FRAMES. */
uint32_t device_step(device *d, frame frames[DEVICE_FRAMES]);
int device_done(const device *d);

#endif
