/* SPDX-License-Identifier: Apache-2.0 */
/* The simulated device on a real CAN interface. */
#ifndef FRAY_TOOLS_BUS_HAND_LIVE_H
#define FRAY_TOOLS_BUS_HAND_LIVE_H

#include <stdint.h>

#include "tools/bus/bus_key.h"
#include "tools/bus/simulated_device.h"

typedef struct {
  const char *interface;
  int free_running;      /* its own 1 kHz; else one pose a hand for each SYNC */
  uint32_t flood_hz;     /* frames a second in addition, of well-formed and of unknown ones; 0: none */
  uint32_t timeout_ms;  /* ends after this time without a SYNC; 0: never */
  bus_key_options key;
} hand_live_options;

/* Until the script is over, SIGINT or SIGTERM. Returns the exit code: 0 good, 1 the runtime
 * stopped sending or the freshness could not be written, 2 interface or key cannot be used. */
int hand_live_run(const script *s, const device_faults *faults, const hand_live_options *o);

#endif
