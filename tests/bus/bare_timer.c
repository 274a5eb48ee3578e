/* SPDX-License-Identifier: Apache-2.0 */
/* bare_timer SECONDS [HZ]: what this machine's clock alone gives a periodic loop: sleeps on an
 * absolute grid, as `fray run --can` does, and does nothing else. Prints the lateness. */
#define _GNU_SOURCE

#include <sched.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PRIORITY = 81 }; /* above fray's: beside it, it measures the machine and not fray */

static int64_t now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static int by_size(const void *a, const void *b) {
  const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
  return (x > y) - (x < y);
}

int main(int argc, char **argv) {
  const long seconds = argc > 1 ? atol(argv[1]) : 10;
  const long hz = argc > 2 ? atol(argv[2]) : 1000;
  if (seconds < 1 || seconds > 3600 || hz < 1 || hz > 10000) {
    fprintf(stderr, "usage: bare_timer SECONDS [HZ]\n");
    return 2;
  }
  const size_t ticks = (size_t)(seconds * hz);
  const int64_t period = 1000000000 / hz;
  int32_t *late_us = malloc(ticks * sizeof *late_us);
  if (late_us == NULL) return 1;
  memset(late_us, 0, ticks * sizeof *late_us);
  const struct sched_param wish = {PRIORITY};
  const int fifo = sched_setscheduler(0, SCHED_FIFO, &wish) == 0;
  int64_t next = now_ns() + period;
  const int64_t end = next + seconds * 1000000000;
  size_t count = 0;
  long missed = 0;
  while (next < end && count < ticks) {
    const struct timespec when = {next / 1000000000, next % 1000000000};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &when, NULL) != 0) {
    }
    const int64_t late = now_ns() - next;
    late_us[count++] = (int32_t)(late / 1000);
    next += period;
    for (; next + period <= now_ns(); next += period) ++missed;
  }
  qsort(late_us, count, sizeof *late_us, by_size);
  printf("p50 %d us, p99 %d us, worst %d us; %ld ticks missed%s\n", (int)late_us[count / 2],
         (int)late_us[count * 99 / 100], (int)late_us[count - 1], missed,
         fifo ? "" : " (not SCHED_FIFO)");
  free(late_us);
  return 0;
}
