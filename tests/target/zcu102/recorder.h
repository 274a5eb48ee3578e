/* SPDX-License-Identifier: Apache-2.0 */
/* What CAN 1 sees of the bus and sends to it, in that order, as `candump -L` would write it. */
#ifndef FRAY_TESTS_TARGET_ZCU102_RECORDER_H
#define FRAY_TESTS_TARGET_ZCU102_RECORDER_H

#include <stdint.h>

#include "rt/wire/frame.h"

void recorder_add(const frame *f, uint64_t time_us);

/* To the console. Returns 0 iff there was no room for all of it. */
int recorder_print(void);

#endif
