/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE

#include "platform/linux/timer.h"

#include <string.h>

#include "platform/linux/sys.h"

enum { BIN_NS = 10000, CLOCK_TRIES = 8 };

int64_t timer_now_ns(void) {
  static int64_t last_ns;
  for (int tries = 0; tries < CLOCK_TRIES; ++tries) {
    struct timespec now;
    if (sys_now(&now) != 0) continue;
    last_ns = (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
    break;
  }
  return last_ns;
}

void timer_begin(timer_grid *t, uint32_t rate_hz) {
  memset(t, 0, sizeof *t);
  t->period_ns = 1000000000 / (int64_t)rate_hz;
  t->next_ns = timer_now_ns() + t->period_ns;
}

int32_t timer_wait(timer_grid *t) {
  int32_t missed = 0;
  int64_t now = timer_now_ns();
  if (now >= t->next_ns + t->period_ns) {
    const int64_t skipped = (now - t->next_ns) / t->period_ns;
    missed = (int32_t)(skipped < INT32_MAX ? skipped : INT32_MAX);
    t->next_ns += skipped * t->period_ns;
  }
  const struct timespec when = {(time_t)(t->next_ns / 1000000000),
                                (long)(t->next_ns % 1000000000)};
  for (uint32_t tries = 0; now < t->next_ns && tries < TIMER_TRIES;) {
    const int64_t before = now;
    const int slept = sys_sleep_until(&when) == 0;
    now = timer_now_ns();
    if (slept && now < t->next_ns) now = t->next_ns; /* the clock could not be read */
    tries = now > before ? 0 : tries + 1;
  }
  const int64_t late = now > t->next_ns ? now - t->next_ns : 0;
  const int64_t bin = late / BIN_NS;
  ++t->lateness[bin < TIMER_BINS ? bin : TIMER_BINS - 1];
  ++t->waits;
  if (late > t->worst_ns) t->worst_ns = late;
  t->next_ns += t->period_ns;
  return missed;
}

int timer_sleep(const timer_grid *t, int64_t us) {
  const int64_t end_ns = timer_now_ns() + us * 1000;
  if (end_ns >= t->next_ns) return 0;
  const struct timespec when = {(time_t)(end_ns / 1000000000), (long)(end_ns % 1000000000)};
  (void)sys_sleep_until(&when);
  return 1;
}

double timer_quantile_us(const timer_grid *t, double share) {
  const double wanted = share * (double)t->waits;
  double seen = 0.0;
  uint32_t bin = 0;
  while (bin + 1 < TIMER_BINS && seen + (double)t->lateness[bin] < wanted) seen += (double)t->lateness[bin++];
  return (bin + 1) * (BIN_NS / 1000.0);
}
