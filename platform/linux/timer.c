/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE

#include "platform/linux/timer.h"

#include <string.h>

#include "platform/linux/sys.h"

enum { BIN_NS = 10000 };

int64_t timer_now_ns(void) {
  struct timespec now;
  while (sys_now(&now) != 0) {
  }
  return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
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
  const struct timespec when = {t->next_ns / 1000000000, t->next_ns % 1000000000};
  while (now < t->next_ns) {
    (void)sys_sleep_until(&when);
    now = timer_now_ns();
  }
  const int64_t late = now - t->next_ns;
  const int64_t bin = late / BIN_NS;
  ++t->lateness[bin < TIMER_BINS ? bin : TIMER_BINS - 1];
  ++t->waits;
  if (late > t->worst_ns) t->worst_ns = late;
  t->next_ns += t->period_ns;
  return missed;
}

double timer_quantile_us(const timer_grid *t, double share) {
  const double wanted = share * t->waits;
  double seen = 0.0;
  uint32_t bin = 0;
  while (bin + 1 < TIMER_BINS && seen + t->lateness[bin] < wanted) seen += t->lateness[bin++];
  return (bin + 1) * (BIN_NS / 1000.0);
}
