/* SPDX-License-Identifier: Apache-2.0 */
#ifndef STAND_IN_DRIVER_H
#define STAND_IN_DRIVER_H

#include <zephyr/drivers/can.h>

extern int driver_down;                              /* 1: nothing can be sent */
void driver_receive(const struct can_frame *frame);  /* the other end sends */
void driver_sent(const struct can_frame *frame);     /* the consumer's: it hears every frame */

#endif
