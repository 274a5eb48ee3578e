/* SPDX-License-Identifier: Apache-2.0 */
/* Ticks of one worker beside those of a team, in turns of a few ticks, on two copies of a world. */
#ifndef FRAY_BENCH_SHARED_TICKS_H
#define FRAY_BENCH_SHARED_TICKS_H

#include "tools/session.h"

typedef struct {
  uint32_t workers;
  uint32_t chosen;            /* by --workers 0 on this machine */
  double one_us, shared_us;   /* a tick, of the best tenth of the turns */
} shared_times;

/* From the session's world as it is, which stays as it is; at most `ticks` ticks of its inputs.
 * Workers have a CPU each where there are as many. Returns 1, or 0 after a message to stderr: also
 * where the hashes are not the same. */
int shared_ticks_time(const session *s, uint32_t ticks, uint32_t workers, shared_times *t);
void shared_ticks_print(FILE *out, const shared_times *t);

#endif
