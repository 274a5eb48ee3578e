/* SPDX-License-Identifier: Apache-2.0 */
/* Cortex-R5F: vectors, modes, floating point on, a region without access below the stack. */
  .syntax unified
  .arm
  .section .vectors, "ax"
  .global reset_vectors
reset_vectors:
  ldr pc, =reset
  ldr pc, =fault_undefined
  ldr pc, =fault_call
  ldr pc, =fault_fetch
  ldr pc, =fault_data
  nop
  ldr pc, =fault_interrupt
  ldr pc, =fault_interrupt
  .ltorg

  .text
  .global reset
reset:
  cpsid if, #0x13                  /* supervisor; every fault comes back to it */
  ldr sp, =stack_top
  mrc p15, 0, r0, c1, c0, 2        /* CPACR: the compiler may move words through the FPU */
  orr r0, r0, #(0xf << 20)
  mcr p15, 0, r0, c1, c0, 2
  isb
  mov r0, #0x40000000
  vmsr fpexc, r0

  mov r0, #0                       /* MPU region 0: the guard, 4 KiB, no access */
  mcr p15, 0, r0, c6, c2, 0
  ldr r0, =guard_first
  mcr p15, 0, r0, c6, c1, 0
  mov r0, #((11 << 1) | 1)         /* 2^(11 + 1) bytes, enabled */
  mcr p15, 0, r0, c6, c1, 2
  mov r0, #(1 << 12)               /* never executed, AP = 0: no access */
  mcr p15, 0, r0, c6, c1, 4
  mrc p15, 0, r0, c1, c0, 0
  bic r0, r0, #(1 << 13)           /* vectors at 0 */
  orr r0, r0, #(1 << 17)           /* everything else as without an MPU */
  orr r0, r0, #1
  dsb
  mcr p15, 0, r0, c1, c0, 0
  isb
  cpsie a                          /* a write that the bus refuses later is a fault too */
  bl bare_start

fault_undefined:
  mov r0, #1
  b fault
fault_call:
  mov r0, #2
  b fault
fault_fetch:
  mov r0, #3
  b fault
fault_data:
  mov r0, #4
  b fault
fault_interrupt:
  mov r0, #6
fault:
  cps #0x13
  ldr sp, =stack_top
  bl bare_fault
  .ltorg
