/* SPDX-License-Identifier: Apache-2.0 */
/* Ticks of one worker beside those of a group, in turns of a few ticks, on two copies of a world. */
#ifndef FRAY_TOOLS_BENCH_WORKER_TICKS_H
#define FRAY_TOOLS_BENCH_WORKER_TICKS_H

#include "tools/recording/session.h"

typedef struct {
  uint32_t workers;
  uint32_t chosen;            /* by --workers 0 on this machine */
  double one_us, workers_us;   /* a tick, of the best tenth of the turns */
} worker_times;

/* From the session's world as it is, which stays as it is; at most `ticks` ticks of its inputs.
 * Workers have a CPU each where there are as many. Returns 1, or 0 after a message to stderr: also
 * where the hashes are not the same. */
int worker_ticks_time(const session *s, uint32_t ticks, uint32_t workers, worker_times *t);
void worker_ticks_print(FILE *out, const worker_times *t);

#endif
