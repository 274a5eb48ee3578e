/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/zcu102/mmu.h"

#include <stdint.h>

#include "platform/zcu102/cpu.h"

enum { PAGE = 4096, BLOCK = 2 * 1024 * 1024, ENTRIES = 512 };

/* Arm ARM, D5.3: descriptors of stage 1 with a granule of 4 KiB. */
#define MMU_TABLE 3ull
#define MMU_PAGE 3ull
#define MMU_BLOCK 1ull
#define MMU_NORMAL (1ull << 2 | 3ull << 8 | 1ull << 10) /* MAIR 1, inner shareable, accessed */
#define MMU_DEVICE (0ull << 2 | 1ull << 10)             /* MAIR 0 */
#define MMU_READ_ONLY (1ull << 7)
#define MMU_NO_CODE (1ull << 53 | 1ull << 54)

extern uint8_t text_first[], text_last[], rodata_first[], rodata_last[], stack_first[], ram_last[];

static _Alignas(PAGE) uint64_t level1[4]; /* of 1 GiB */
static _Alignas(PAGE) uint64_t level2[ENTRIES]; /* of 2 MiB, the first GiB */
static _Alignas(PAGE) uint64_t level3[ENTRIES]; /* of 4 KiB, the first 2 MiB: the program */

static void map_pages(const uint8_t *first, const uint8_t *last, uint64_t kind) {
  for (uintptr_t at = (uintptr_t)first; at < (uintptr_t)last; at += PAGE)
    level3[at / PAGE] = at | kind | MMU_PAGE;
}

static void fill_tables(void) {
  map_pages(text_first, text_last, MMU_NORMAL | MMU_READ_ONLY);
  map_pages(rodata_first, rodata_last, MMU_NORMAL | MMU_READ_ONLY | MMU_NO_CODE);
  map_pages(stack_first, ram_last, MMU_NORMAL | MMU_NO_CODE);
  level2[0] = (uintptr_t)level3 | MMU_TABLE;
  for (uint64_t n = 1; n < ENTRIES; ++n)
    level2[n] = n * BLOCK | MMU_NORMAL | MMU_NO_CODE | MMU_BLOCK;
  level1[0] = (uintptr_t)level2 | MMU_TABLE;
  level1[3] = 0xC0000000ull | MMU_DEVICE | MMU_NO_CODE | MMU_BLOCK;
}

void mmu_begin(void) {
  fill_tables();
  CPU_WRITE(mair_el1, 0xFF00);                  /* 0: device nGnRnE; 1: write-back */
  CPU_WRITE(tcr_el1, 32u | 1u << 8 | 1u << 10   /* 4 GiB; tables are write-back, */
                         | 3u << 12 | 1u << 23); /* inner shareable; no upper half */
  CPU_WRITE(ttbr0_el1, (uintptr_t)level1);
  __asm__ volatile("dsb sy\n tlbi vmalle1\n ic iallu\n dsb sy\n isb" ::: "memory");
  CPU_WRITE(sctlr_el1, CPU_READ(sctlr_el1) | 1u | 1u << 2 | 1u << 12); /* M, C, I */
}
