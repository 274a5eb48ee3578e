/* SPDX-License-Identifier: Apache-2.0 */
/* fray_tick() with a clock around every stage: the same source, compiled a second time. */
#ifndef FRAY_TOOLS_BENCH_TIMED_TICK_H
#define FRAY_TOOLS_BENCH_TIMED_TICK_H

#include "rt/fray.h"

#define TIMED_STAGES(X) \
  X(DEVICES, "devices") X(DAMP, "damping") X(BEND_SHEAR, "bend and shear") X(STRESS, "stress") \
  X(MEMBRANE_TEAR, "membrane tear") X(CRACK, "cracks") X(BLADE_CUT, "blade cut") X(GAINS, "gains") X(WIND, "wind") \
  X(GATHER, "broad phase") X(YARN_COLLISION, "yarn collision") \
  X(TRIANGLE_COLLISION, "triangle collision") X(CONTACT_VERTICES, "rigid meshes") \
  X(ADVANCE, "motion") X(ELASTIC, "elastic steps") X(STRAIN, "strain limit") \
  X(YARN_SLIP, "yarn slip") X(CONTACT_PRIMITIVES, "contacts") \
  X(TRANSITION, "transitions") X(SPLIT, "splits") X(TEAR, "tear test") X(BREAK, "breaks") \
  X(VELOCITY, "velocities") X(FORCE, "forces") X(REPORT, "report and hash")

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
