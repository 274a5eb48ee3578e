/* SPDX-License-Identifier: Apache-2.0 */
/* Instructions of the A53 that C cannot express, and registers of devices. */
#ifndef FRAY_PLATFORM_ZCU102_CPU_H
#define FRAY_PLATFORM_ZCU102_CPU_H

#include <stdint.h>

#define CPU_READ(name)                                              \
  __extension__({                                                   \
    uint64_t cpu_value;                                             \
    __asm__ volatile("mrs %0, " #name : "=r"(cpu_value)::"memory"); \
    cpu_value;                                                      \
  })
#define CPU_WRITE(name, value) \
  __asm__ volatile("msr " #name ", %0\n isb" ::"r"((uint64_t)(value)) : "memory")

static inline void cpu_mask_interrupts(void) {
  __asm__ volatile("msr daifset, #2" ::: "memory");
}
static inline void cpu_allow_interrupts(void) {
  __asm__ volatile("msr daifclr, #2\n isb" ::: "memory");
}
/* A write that the bus refuses later is a fault too; masked, as after the reset, it is lost. */
static inline void cpu_allow_aborts(void) { __asm__ volatile("msr daifclr, #4" ::: "memory"); }

/* Returns when an interrupt is pending, masked or not. */
static inline void cpu_sleep(void) { __asm__ volatile("dsb sy\n wfi" ::: "memory"); }

static inline uint32_t device_read(uintptr_t base, uint32_t offset) {
  return *(const volatile uint32_t *)(base + offset);
}
static inline void device_write(uintptr_t base, uint32_t offset, uint32_t value) {
  *(volatile uint32_t *)(base + offset) = value;
}

#endif
