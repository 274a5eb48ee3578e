/* SPDX-License-Identifier: Apache-2.0 */
/* The bus between CAN 0 and CAN 1: QEMU's own (wire_qemu.c, with platform/zcu102/can.c), where a
 * frame passes at once and needs nobody, or one of bits and acknowledges (wire_model.c, instead of
 * both). */
#ifndef FRAY_TESTS_TARGET_ZCU102_WIRE_H
#define FRAY_TESTS_TARGET_ZCU102_WIRE_H

#include <stdint.h>

enum { WIRE_QUIET_US = 1000 }; /* at most so long until the next wire_step() */

/* What is due on the bus; returns when it wants to be called again, in counts of the timer. Called
 * in the timer's interrupt. */
uint64_t wire_step(uint64_t now);

/* Times that CAN 0 was read as the input of a tick while the SYNC still stood in its buffer, and
 * times that another frame of CAN 0 was confirmed meanwhile: the first must not come of the
 * second. */
uint32_t wire_early(void);
uint32_t wire_crossed(void);

/* Microseconds that frames took on the bus. */
uint64_t wire_busy_us(void);

#endif
