/* SPDX-License-Identifier: Apache-2.0 */
#ifndef STAND_IN_CAN_H
#define STAND_IN_CAN_H

#include <stdint.h>
#include <zephyr/device.h>
#include <zephyr/kernel.h>

#define CAN_FRAME_IDE 1u
#define CAN_FRAME_RTR 2u

struct can_frame {
  uint32_t id;
  uint8_t dlc, flags;
  uint8_t data[8];
};
struct can_filter {
  uint32_t id, mask;
  uint8_t flags;
};
typedef void (*can_rx_callback_t)(const struct device *dev, struct can_frame *frame, void *user);
typedef void (*can_tx_callback_t)(const struct device *dev, int error, void *user);

int can_add_rx_filter(const struct device *dev, can_rx_callback_t callback, void *user,
                      const struct can_filter *filter);
int can_start(const struct device *dev);
int can_send(const struct device *dev, const struct can_frame *frame, k_timeout_t timeout,
             can_tx_callback_t callback, void *user);
static inline uint8_t can_dlc_to_bytes(uint8_t dlc) { return dlc; }
static inline uint8_t can_bytes_to_dlc(uint8_t bytes) { return bytes; }

#endif
