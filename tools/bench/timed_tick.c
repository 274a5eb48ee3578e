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

static double clock_ns(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (double)now.tv_sec * 1e9 + (double)now.tv_nsec;
}

double timed_now_ns(void) { return clock_ns(CLOCK_MONOTONIC); }

double timed_cpu_ns(void) { return clock_ns(CLOCK_THREAD_CPUTIME_ID); }

/* One look at the clock a stage: a stage lasts from the end of the one before. */
static double stage_began_ns;
int timed_by_cpu;

static double stage_clock_ns(void) { return timed_by_cpu ? timed_cpu_ns() : timed_now_ns(); }

static void end_stage(timed_stage stage) {
  const double now = stage_clock_ns();
  timed_ns[stage] += now - stage_began_ns;
  stage_began_ns = now;
}

#define STEP_STAGE(name, call) \
  do { \
    call; \
    end_stage(TIMED_##name); \
  } while (0)
#define fray_tick timed_step
#include "rt/run/step.c"

void timed_tick(fray_world *world, const fray_input *input, fray_output *output) {
  stage_began_ns = stage_clock_ns();
  timed_step(world, input, output);
}
