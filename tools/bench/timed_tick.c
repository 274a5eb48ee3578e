/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L

#include "tools/bench/timed_tick.h"

#include <time.h>

double timed_ns[TIMED_COUNT];
const char *const timed_labels[TIMED_COUNT] = {
#define X(name, label) label,
    TIMED_STAGES(X)
#undef X
};

double timed_now_ns(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec * 1e9 + (double)now.tv_nsec;
}

#define STEP_STAGE(name, call) \
  do { \
    const double before = timed_now_ns(); \
    call; \
    timed_ns[TIMED_##name] += timed_now_ns() - before; \
  } while (0)
#define fray_tick timed_tick
#include "rt/run/step.c"
