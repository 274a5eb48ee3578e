/* SPDX-License-Identifier: Apache-2.0 */
/* What the loop calls of platform/platform.h over Zephyr's CAN driver: classic CAN, so not under a
 * key in FD form. One world on one controller, run by one thread. */
#ifndef FRAY_PLATFORM_ZEPHYR_BOARD_H
#define FRAY_PLATFORM_ZEPHYR_BOARD_H

#include <zephyr/device.h>

/* Starts the controller, takes every standard frame, and begins the grid of ticks now.
 * Returns 0, or a negative errno of the driver. The bit rate is the devicetree's. */
int board_begin(const struct device *can);

/* Makes platform_wait() return -1 from now on. Context: any thread or interrupt. */
void board_stop(void);

#endif
