/* SPDX-License-Identifier: Apache-2.0 */
/* A stand-in: as much of Zephyr's interface as the board uses, over two queues in memory. */
#ifndef STAND_IN_DEVICE_H
#define STAND_IN_DEVICE_H

struct device {
  const char *name;
};

#endif
