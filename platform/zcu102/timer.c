/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/zcu102/timer.h"

#include "platform/zcu102/cpu.h"

enum { CNTV_ENABLE = 1, CNTV_MASK = 2 };

uint64_t timer_now(void) {
  __asm__ volatile("isb" ::: "memory");
  return CPU_READ(cntvct_el0);
}

uint64_t timer_counts(uint32_t us) { return us * CPU_READ(cntfrq_el0) / 1000000u; }

/* count * to / from, down, without a product above 2^64. */
static uint64_t scaled(uint64_t count, uint64_t to, uint64_t from) {
  return count / from * to + count % from * to / from;
}

uint64_t timer_us(uint64_t counts) { return scaled(counts, 1000000u, CPU_READ(cntfrq_el0)); }

/* Interrupts are masked between the look and the sleep: one that comes there ends the sleep. */
void timer_sleep(uint64_t end, const volatile uint32_t *flag) {
  cpu_mask_interrupts();
  while ((flag == 0 || *flag == 0) && timer_now() < end) {
    CPU_WRITE(cntv_cval_el0, end);
    CPU_WRITE(cntv_ctl_el0, CNTV_ENABLE);
    cpu_sleep();
    cpu_allow_interrupts();
    cpu_mask_interrupts();
  }
  CPU_WRITE(cntv_ctl_el0, 0);
  cpu_allow_interrupts();
}

void timer_interrupt(void) { CPU_WRITE(cntv_ctl_el0, CNTV_ENABLE | CNTV_MASK); }

/* Multiplied out from the start, so that no rate drifts. */
static uint64_t grid_at(const timer_grid *g, uint64_t n) {
  const uint64_t hz = CPU_READ(cntfrq_el0);
  return g->start + n / g->rate_hz * hz + (n % g->rate_hz * hz + g->rate_hz - 1u) / g->rate_hz;
}

void timer_begin(timer_grid *g, uint32_t rate_hz) {
  g->start = timer_now();
  g->next = 1;
  g->rate_hz = rate_hz;
  g->worst_us = 0;
}

int32_t timer_wait(timer_grid *g) {
  const uint64_t passed = scaled(timer_now() - g->start, g->rate_hz, CPU_READ(cntfrq_el0));
  const uint64_t missed = passed > g->next ? passed - g->next : 0;
  g->next += missed;
  timer_sleep(grid_at(g, g->next), 0);
  const uint64_t late_us = timer_us(timer_now() - grid_at(g, g->next));
  if (late_us > g->worst_us) g->worst_us = (uint32_t)(late_us < UINT32_MAX ? late_us : UINT32_MAX);
  ++g->next;
  return missed < INT32_MAX ? (int32_t)missed : INT32_MAX;
}
