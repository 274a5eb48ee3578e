/* SPDX-License-Identifier: Apache-2.0 */
/* Lateness of a grid that has waited more than 2^32 times. */
#include "platform/linux/timer.h"
#include "tests/lib/test.h"

static void shares_of_many_waits(void) {
  static timer_grid t;
  const uint64_t many = UINT64_C(1) << 33;
  t.waits = many;
  t.lateness[0] = many / 2;
  t.lateness[4] = many / 2 - 4;
  t.lateness[7] = 4;
  CHECK(timer_quantile_us(&t, 0.5) == 10.0);
  CHECK(timer_quantile_us(&t, 0.99) == 50.0);
  CHECK(timer_quantile_us(&t, 1.0) == 80.0);
}

static void a_wait_is_counted(void) {
  static timer_grid t;
  uint64_t bins = 0;
  timer_begin(&t, 10000);
  t.waits = t.lateness[TIMER_BINS - 1] = UINT32_MAX;
  (void)timer_wait(&t);
  for (uint32_t n = 0; n < TIMER_BINS; ++n) bins += t.lateness[n];
  CHECK(t.waits == UINT64_C(1) << 32 && bins == t.waits);
}

int main(void) {
  TEST(shares_of_many_waits);
  TEST(a_wait_is_counted);
  return test_end();
}
