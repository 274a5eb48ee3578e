/* SPDX-License-Identifier: Apache-2.0 */
/* fray_tick() with a clock around every stage: the same source, compiled a second time. */
#ifndef FRAY_BENCH_TIMED_TICK_H
#define FRAY_BENCH_TIMED_TICK_H

#include "rt/fray.h"

#define TIMED_STAGES(X) \
  X(DEVICES, "devices") X(DAMP, "damp") X(SPRINGS, "springs") X(GATHER, "gather") X(STRESS, "stress") \
  X(RIP, "rip") X(SLASH, "slash") X(WEIGH, "weigh") X(BLOW, "blow") X(LIMIT, "limit") \
  X(PREDICT, "predict") X(STRAIN, "strain") X(SLIP, "slip") X(COLLIDE, "collide") X(MESHES, "meshes") \
  X(TRANSITION, "transition") X(SPLIT, "split") X(SELVES, "selves") X(LAYERS, "layers") X(TEAR, "tear") \
  X(CUT, "cut") X(FINISH, "finish") X(FORCE, "force") X(REPORT, "report and hash")

typedef enum {
#define X(name, label) TIMED_##name,
  TIMED_STAGES(X)
#undef X
  TIMED_COUNT
} timed_stage;

extern const char *const timed_labels[TIMED_COUNT];
extern double timed_ns[TIMED_COUNT]; /* since the caller last cleared it */

double timed_now_ns(void);
double timed_cpu_ns(void); /* of this thread: stands still while others have its processor */
/* Stages by the thread's own time, which takes a system call a stage: for ticks so long that others
 * come between. */
extern int timed_by_cpu;
void timed_tick(fray_world *world, const fray_input *input, fray_output *output);

#endif
