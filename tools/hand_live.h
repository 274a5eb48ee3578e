/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated device on a real CAN interface. */
#ifndef FRAY_TOOLS_HAND_LIVE_H
#define FRAY_TOOLS_HAND_LIVE_H

#include <stdint.h>

#include "tools/bus_key.h"
#include "tools/device.h"

typedef struct {
  const char *interface;
  int free_running;      /* its own 1 kHz; else one pose a hand for each SYNC */
  uint32_t flood_hz;     /* frames a second of valid-looking and unknown ids besides, 0: none */
  uint32_t patience_ms;  /* ends after so long without a SYNC; 0: waits for ever */
  bus_key_options key;
} hand_live_options;

/* Until the script is over, SIGINT or SIGTERM. Returns the exit code: 0 good, 1 the runtime fell
 * silent or the freshness could not be written, 2 interface or key cannot be used. */
int hand_live_run(const script *s, const device_trouble *trouble, const hand_live_options *o);

#endif
