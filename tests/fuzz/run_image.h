/* SPDX-License-Identifier: Apache-2.0 */
/* Runs an image's world as tests/lib/hostile_run.h does, and counts: beside each quarter of the worlds a wide kernel
 * in lockstep. */
#ifndef FRAY_TESTS_FUZZ_RUN_IMAGE_H
#define FRAY_TESTS_FUZZ_RUN_IMAGE_H

#include "platform/linux/cpu.h"
#include "tests/lib/hostile_run.h"

/* Work that was counted (fray_work), after which a world runs no more ticks: 200 of any small seed are less. */
enum { RUN_TICKS = 200, RUN_WORK_MAX = 125000, RUN_WORK_LONG = 500000, RUN_LOCKSTEP = 4 };

static struct {
  unsigned long executions, ran, whole, ticks;
} run_tally;

static inline void run_report(void) {
  printf("tally %lu executions, %lu accepted and run, %lu of them for %d ticks, %lu ticks\n", run_tally.executions,
         run_tally.ran, run_tally.whole, RUN_TICKS, run_tally.ticks);
}

/* Once in each execution. */
static inline void run_count(void) {
  if (run_tally.executions++ == 0) (void)atexit(run_report);
}

/* Returns the ticks. */
static inline uint32_t run_world(fray_world *w, uint32_t ticks_max, uint64_t work_max, uint64_t seed) {
  uint64_t draws = seed ^ 1u;
  const fray_kernel wide = hostile_draw(&draws, 2) != 0 && cpu_has(FRAY_KERNEL_AVX512) ? FRAY_KERNEL_AVX512
                           : cpu_has(FRAY_KERNEL_AVX2)                                 ? FRAY_KERNEL_AVX2
                                                                                       : FRAY_KERNEL_SCALAR;
  const int in_lockstep = hostile_draw(&draws, RUN_LOCKSTEP) == 0;
  const uint32_t ticks = hostile_run(w, ticks_max, work_max, in_lockstep, wide, seed);
  run_tally.ran += 1;
  run_tally.whole += ticks >= RUN_TICKS;
  run_tally.ticks += ticks;
  return ticks;
}

/* The compiler must not make what the loader refuses. Takes the image. */
static inline void run_image(uint8_t *image, size_t bytes, uint32_t ticks) {
  hostile_world h;
  if (hostile_open(&h, image, bytes, NULL) != FRAY_OK) hostile_fail("a compiled image is refused");
  (void)run_world(h.w, ticks, RUN_WORK_LONG, bytes);
  hostile_close(&h);
}

#endif
