/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/zcu102/gic.h"

#include "platform/zcu102/cpu.h"

static const uintptr_t distributor = 0xF9010000u;
static const uintptr_t core = 0xF9020000u;
enum { GICD_CTLR = 0x000, GICD_ISENABLER = 0x100, GICD_ICENABLER = 0x180, GICD_IPRIORITYR = 0x400,
       GICD_ITARGETSR = 0x800 };
enum { GICC_CTLR = 0x00, GICC_PMR = 0x04, GICC_IAR = 0x0C, GICC_EOIR = 0x10 };
enum { LINES = 192 };

void gic_begin(void) {
  device_write(distributor, GICD_CTLR, 0);
  for (uint32_t n = 0; n < LINES / 32; ++n)
    device_write(distributor, GICD_ICENABLER + 4 * n, 0xFFFFFFFFu);
  device_write(core, GICC_PMR, 0xF8);
  device_write(core, GICC_CTLR, 1);
  device_write(distributor, GICD_CTLR, 1);
}

static void write_byte(uint32_t field, uint32_t id, uint8_t value) {
  *(volatile uint8_t *)(distributor + field + id) = value;
}

void gic_enable(uint32_t id, uint8_t priority) {
  write_byte(GICD_IPRIORITYR, id, priority);
  if (id >= 32) write_byte(GICD_ITARGETSR, id, 1);
  device_write(distributor, GICD_ISENABLER + id / 32 * 4, 1u << id % 32);
}

uint32_t gic_take(void) { return device_read(core, GICC_IAR); }
void gic_done(uint32_t taken) { device_write(core, GICC_EOIR, taken); }
