/* SPDX-License-Identifier: Apache-2.0 */
/* Times of the parts of a tearing membrane's tick, before its first tear and while it tears: what a tick spends on
 * collisions, on deformation, on tears, and on all else. */
#ifndef FRAY_TOOLS_BENCH_TEAR_PHASES_H
#define FRAY_TOOLS_BENCH_TEAR_PHASES_H

#include <stdint.h>

#include "tools/bench/timed_tick.h"

/* Deformation has what contacts do in its elastic steps; tearing has the stress of triangles, as nothing else in a
 * tick uses it. */
typedef enum { TEAR_COLLISION, TEAR_DEFORMATION, TEAR_TEARING, TEAR_REST, TEAR_TOTAL, TEAR_PARTS } tear_part;
extern const char *const tear_part_labels[TEAR_PARTS];

typedef enum { TEAR_BEFORE, TEAR_WHILE, TEAR_PHASES } tear_phase_kind;
extern const char *const tear_phase_labels[TEAR_PHASES];

typedef struct {
  uint32_t ticks; /* 0: there is no such phase */
  double mean_ns[TEAR_PARTS], worst_ns[TEAR_PARTS]; /* each part's own worst tick */
} tear_phase;

/* Of ticks first..end - 1; stage_ns has TIMED_COUNT a tick, from tick 0 on. */
tear_phase tear_phase_of(const float *stage_ns, uint32_t first, uint32_t end);

#endif
