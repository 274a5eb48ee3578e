/* SPDX-License-Identifier: Apache-2.0 */
/* The generic timer of the core: a fixed grid of ticks on the virtual counter. */
#ifndef FRAY_PLATFORM_ZCU102_TIMER_H
#define FRAY_PLATFORM_ZCU102_TIMER_H

#include <stdint.h>

typedef struct {
  uint64_t start;    /* counts */
  uint64_t next;     /* number of the coming tick */
  uint32_t rate_hz;
  uint32_t worst_us; /* lateness of a tick that was not missed */
} timer_grid;

uint64_t timer_now(void); /* counts */
uint64_t timer_counts(uint32_t us);
uint64_t timer_us(uint64_t counts);

/* Sleeps until the counter says `end` or *flag is not 0, which an interrupt sets; flag may be 0. */
void timer_sleep(uint64_t end, const volatile uint32_t *flag);

/* The timer's interrupt. */
void timer_interrupt(void);

void timer_begin(timer_grid *g, uint32_t rate_hz);

/* Sleeps to the next tick; returns how many were missed before it: they are skipped, the grid
 * stays. */
int32_t timer_wait(timer_grid *g);

#endif
