/* SPDX-License-Identifier: Apache-2.0 */
/* The interrupt controller (GIC-400, Arm IHI 0048B), for core 0. */
#ifndef FRAY_PLATFORM_ZCU102_GIC_H
#define FRAY_PLATFORM_ZCU102_GIC_H

#include <stdint.h>

enum { /* UG1085, table 13-1 */
  GIC_TIMER_VIRTUAL = 27,
  GIC_TIMER_SECURE = 29,
  GIC_TIMER_PHYSICAL = 30,
  GIC_CAN0 = 55,
  GIC_CAN1 = 56,
  GIC_NONE = 1020 /* and above: nothing is pending */
};

/* Everything off, then distributor and core interface on. */
void gic_begin(void);

/* A lower priority number comes first; 0..0xF0 in steps of 0x10. */
void gic_enable(uint32_t id, uint8_t priority);

/* The pending interrupt of the highest priority; acknowledge it with gic_done() when it was handled. */
uint32_t gic_take(void);
void gic_done(uint32_t taken);

#endif
