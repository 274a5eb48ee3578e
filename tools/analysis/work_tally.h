/* SPDX-License-Identifier: Apache-2.0 */
/* Counted work of a run in instructions of a Cortex-M3 (rt/README.md has the table), while the cloth is
 * intact and after the first split or tear, beside the image's bound. */
#ifndef FRAY_TOOLS_ANALYSIS_WORK_TALLY_H
#define FRAY_TOOLS_ANALYSIS_WORK_TALLY_H

#include <stdio.h>

#include "rt/fray.h"

enum { TALLY_INTACT, TALLY_TORN, TALLY_PHASES };

typedef struct {
  fray_work limits;
  double *ticks[TALLY_PHASES];
  uint32_t count[TALLY_PHASES], room[TALLY_PHASES];
  double worst, worst_events; /* of all ticks: work, and the part of events in it */
  uint32_t beyond;            /* ticks with a count above its limit */
  int torn, failed;           /* failed: memory ran out, ticks are missing */
} work_tally;

void work_tally_open(work_tally *t, const fray_world *w);
void work_tally_add(work_tally *t, const fray_output *output);
void work_tally_print(work_tally *t, FILE *out); /* sorts the ticks */
void work_tally_close(work_tally *t);

#endif
