/* SPDX-License-Identifier: Apache-2.0 */
/* RV32 in machine mode, hart 0: stack, a locked region without access below it, faults. */
  .section .vectors, "ax"
  .global reset
reset:
  .option push
  .option norelax
  la gp, __global_pointer$
  .option pop
  csrr t0, mhartid
others:
  bnez t0, others
  la sp, stack_top
  la t0, trap
  csrw mtvec, t0

  /* PMP entry 0: the guard, 4 KiB, naturally aligned; locked, so that it holds machine mode too */
  la t0, guard_first
  srli t0, t0, 2
  ori t0, t0, (4096 / 8 - 1)
  csrw pmpaddr0, t0
  li t0, 0x98
  csrw pmpcfg0, t0
  call bare_start

  .balign 4
trap:
  la sp, stack_top
  csrr a0, mcause
  call bare_fault
