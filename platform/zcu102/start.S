/* SPDX-License-Identifier: Apache-2.0 */
/* Cortex-A53: from whatever exception level the loader left us in to EL1 with a stack, data and
 * bss, then board_main. From EL3 it stays in the secure world. Floating point stays trapped:
 * nothing here has it, and a use is a bug. Only core 0 runs. */

  .section .start, "ax"
  .globl reset_entry
reset_entry:
  msr daifset, #15
  mrs x0, mpidr_el1
  tst x0, #0xFF
  b.ne park
  mrs x0, CurrentEL
  cmp x0, #(2 << 2)
  b.eq from_el2
  b.lt in_el1

from_el3:
  mrs x0, S3_1_C15_C2_1     /* CPUECTLR.SMPEN, before any cache is on; below EL3 a loader did it */
  orr x0, x0, #(1 << 6)
  msr S3_1_C15_C2_1, x0
  mov x0, #0xC30            /* SCR: EL1 is AArch64, may use the secure timer; secure; RES1 bits */
  msr scr_el3, x0
  msr cptr_el3, xzr
  mov x0, #0x3C5            /* EL1, own stack pointer, all masked */
  msr spsr_el3, x0
  adr x0, in_el1
  msr elr_el3, x0
  eret

from_el2:
  mov x0, #(1 << 31)        /* HCR: EL1 is AArch64, nothing is virtual */
  msr hcr_el2, x0
  mov x0, #3                /* CNTHCTL: EL1 may use the physical timer and counter */
  msr cnthctl_el2, x0
  msr cntvoff_el2, xzr
  mov x0, #0x3C5
  msr spsr_el2, x0
  adr x0, in_el1
  msr elr_el2, x0
  eret

in_el1:
  ldr x0, =0x30D00800       /* SCTLR: MMU and caches off, the RES1 bits */
  msr sctlr_el1, x0
  msr cpacr_el1, xzr
  adrp x0, vectors
  add x0, x0, :lo12:vectors
  msr vbar_el1, x0
  isb
  ldr x0, =stack_top
  mov sp, x0

  ldr x0, =data_first
  ldr x1, =data_last
  ldr x2, =data_load
copy_data:
  cmp x0, x1
  b.hs copied_data
  ldr x3, [x2], #8
  str x3, [x0], #8
  b copy_data
copied_data:
  ldr x0, =bss_first
  ldr x1, =bss_last
zero_bss:
  cmp x0, x1
  b.hs zeroed_bss
  str xzr, [x0], #8
  b zero_bss
zeroed_bss:
  ldr x0, =stack_first       /* painted, so that board_stack_used() sees how deep it went */
  ldr x1, =0x5A5A5A5A5A5A5A5A
  mov x2, sp
paint_stack:
  cmp x0, x2
  b.hs painted_stack
  str x1, [x0], #8
  b paint_stack
painted_stack:
  bl board_main

park:
  wfe
  b park

/* Sixteen entries of 128 bytes. Only an interrupt at EL1 on its own stack is expected; any other
 * is a fault, and says which. */
  .macro fault kind
  .balign 128
  mov x0, #\kind
  b fault_entry
  .endm

  .section .text.vectors, "ax"
  .balign 2048
vectors:
  .irp kind, 0, 1, 2, 3, 4
  fault \kind
  .endr
  .balign 128
  b interrupt_entry
  .irp kind, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15
  fault \kind
  .endr

/* Interrupts do not nest, so what the exception saved stays in its registers. */
  .macro callers op
  \op x0, x1, [sp, #16]
  \op x2, x3, [sp, #32]
  \op x4, x5, [sp, #48]
  \op x6, x7, [sp, #64]
  \op x8, x9, [sp, #80]
  \op x10, x11, [sp, #96]
  \op x12, x13, [sp, #112]
  \op x14, x15, [sp, #128]
  \op x16, x17, [sp, #144]
  .endm
interrupt_entry:
  stp x29, x30, [sp, #-176]!
  callers stp
  str x18, [sp, #160]
  bl board_interrupt
  ldr x18, [sp, #160]
  callers ldp
  ldp x29, x30, [sp], #176
  eret

/* The stack may be what is broken: begin it anew; there is no return. */
fault_entry:
  ldr x4, =stack_top
  mov sp, x4
  mrs x1, esr_el1
  mrs x2, elr_el1
  mrs x3, far_el1
  bl board_fault
  b park
