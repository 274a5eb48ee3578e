/* SPDX-License-Identifier: Apache-2.0 */
/* A fixed grid of ticks on the monotonic clock. */
#ifndef FRAY_PLATFORM_LINUX_TIMER_H
#define FRAY_PLATFORM_LINUX_TIMER_H

#include <stdint.h>

enum {
  TIMER_BINS = 4096,   /* of 10 us each; the last holds everything later */
  TIMER_TRIES = 1000 /* failed sleeps while the clock does not move */
};

typedef struct {
  int64_t period_ns;
  int64_t next_ns;              /* of the coming tick */
  uint64_t lateness[TIMER_BINS]; /* counts, by 10 us */
  uint64_t waits;
  int64_t worst_ns;
} timer_grid;

/* Nanoseconds of the monotonic clock. If the clock cannot be read, the last time that could: time stops
 * then, so loops that wait for a time also count their turns. */
int64_t timer_now_ns(void);
void timer_begin(timer_grid *t, uint32_t rate_hz);

/* Sleeps to the next tick; returns how many whole periods were missed before it (they are skipped, the grid
 * stays). A failing or interrupted sleep is tried again until the time is reached. A sleep that succeeds
 * counts as in time if the clock cannot be read. With neither, TIMER_TRIES tries. */
int32_t timer_wait(timer_grid *t);

/* Sleeps so long, but not up to the next tick. Returns 0 iff that comes sooner. Cost: at most one sleep; a signal ends
 * it. us: 1..1000000. */
int timer_sleep(const timer_grid *t, int64_t us);

/* Lateness in microseconds that `share` (0..1) of all waits did not exceed, to 10 us. */
double timer_quantile_us(const timer_grid *t, double share);

#endif
