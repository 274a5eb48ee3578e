/* SPDX-License-Identifier: Apache-2.0 */
/* A fixed grid of ticks on the monotonic clock. */
#ifndef FRAY_LINUX_TIMER_H
#define FRAY_LINUX_TIMER_H

#include <stdint.h>

enum {
  TIMER_BINS = 4096,   /* of 10 us each; the last holds everything later */
  TIMER_TRIES = 1000 /* sleeps that fail while the clock stands still */
};

typedef struct {
  int64_t period_ns;
  int64_t next_ns;              /* of the coming tick */
  uint32_t lateness[TIMER_BINS]; /* counts, by 10 us */
  uint32_t waits;
  int64_t worst_ns;
} timer_grid;

/* Nanoseconds of the monotonic clock. When the clock cannot be read, the last time that was: it
 * stands still then, and whoever waits for a time also counts. */
int64_t timer_now_ns(void);
void timer_begin(timer_grid *t, uint32_t rate_hz);

/* Sleeps to the next tick; returns how many whole periods were missed before it (they are
 * skipped, the grid stays). A failing or interrupted sleep is tried again until the time is
 * reached. A sleep that succeeds is believed without a clock. With neither, TIMER_TRIES tries. */
int32_t timer_wait(timer_grid *t);

/* Lateness in microseconds that `share` (0..1) of all waits did not exceed, to 10 us. */
double timer_quantile_us(const timer_grid *t, double share);

#endif
