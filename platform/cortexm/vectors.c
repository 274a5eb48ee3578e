/* SPDX-License-Identifier: Apache-2.0 */
/* Cortex-M (v6-M, v7-M, v8-M): vectors and reset. A board adds its own interrupts behind the
 * sixteen of the core, as an array in the section .vectors.board. */
#include <stdint.h>

#include "platform/bare/bare.h"
#include "platform/cortexm/systick.h"

extern uint32_t stack_first[], stack_top[], guard_first[];

_Noreturn void reset_handler(void);
static void fault_handler(void);

typedef void (*vector)(void);
__attribute__((section(".vectors"), used)) static const struct {
  uint32_t *stack;
  vector handler[15];
} vectors = {stack_top,
             {reset_handler, fault_handler, fault_handler, fault_handler, fault_handler,
              fault_handler, fault_handler, 0, 0, 0, fault_handler, fault_handler, 0,
              fault_handler, systick_handler}};

/* The stack itself may have failed: it is set to its top before anything is stored. IPSR names the
 * exception: 3 HardFault, 4 MemManage, 5 BusFault, 6 UsageFault. */
__attribute__((naked)) static void fault_handler(void) {
  __asm__ volatile(
      "ldr r0, =stack_top\n"
      "mov sp, r0\n"
      "mrs r0, ipsr\n"
      "ldr r1, =bare_fault\n"
      "bx r1\n");
}

/* v8-M has a limit for the stack, v7-M a region without access below it where there is an MPU. */
static void guard_stack(void) {
#if defined(__ARM_ARCH_8M_MAIN__) || defined(__ARM_ARCH_8_1M_MAIN__)
  __asm__ volatile("msr msplim, %0" : : "r"(stack_first));
#elif defined(__ARM_ARCH_7M__) || defined(__ARM_ARCH_7EM__)
  enum { NEVER_EXECUTED = 1 << 28, SIZE_4K = 11 << 1, ENABLE = 1, ELSE_AS_WITHOUT = 4 };
  volatile uint32_t *const mpu = (volatile uint32_t *)0xE000ED90u;
  if (mpu[0] == 0) return;                       /* TYPE: no regions */
  mpu[2] = 0;                                    /* RNR */
  mpu[3] = (uint32_t)(uintptr_t)guard_first;     /* RBAR */
  mpu[4] = NEVER_EXECUTED | SIZE_4K | ENABLE;    /* RASR: no access */
  mpu[1] = ELSE_AS_WITHOUT | ENABLE;             /* CTRL */
  __asm__ volatile("dsb\nisb" : : : "memory");
#endif
}

/* A bootloader may have left its own vectors behind; v6-M has them at 0. */
static void take_vectors(void) {
#if !defined(__ARM_ARCH_6M__)
  *(volatile uint32_t *)0xE000ED08u = (uint32_t)(uintptr_t)&vectors; /* VTOR */
  __asm__ volatile("dsb" : : : "memory");
#endif
}

_Noreturn void reset_handler(void) {
  take_vectors();
  guard_stack();
#if defined(__ARM_FP) || defined(__ARM_FEATURE_MVE)
  *(volatile uint32_t *)0xE000ED88u |= 0xFu << 20; /* CPACR: the compiler may move words there */
  __asm__ volatile("dsb\nisb" : : : "memory");
#endif
  bare_start();
}
