/* SPDX-License-Identifier: Apache-2.0 */
/* A recording against a world that runs again from its start: the hash in every SYNC, and every FORCE, ACK, TEAR,
 * STATUS and IDENTITY. README.md says which changes of a recording it refuses.
 *
 * Of STATUS the field Overruns is a matter of clocks: it may only rise. IDENTITY names the physics of the runtime that
 * recorded; another one than this build's is said first, and the hashes decide. */
#ifndef FRAY_TOOLS_RECORDING_VERIFY_H
#define FRAY_TOOLS_RECORDING_VERIFY_H

#include <stdint.h>
#include <stdio.h>

#include "platform/linux/workers.h"
#include "platform/log/candump.h"

typedef struct {
  const char *file;      /* of the recording, for messages */
  const candump_log *log; /* plain, with a SYNC of this instance */
  uint32_t instance;     /* 0..7 */
  int cut;               /* it may end anywhere: verifies the ticks that are whole */
} verify_recording;

/* Runs the world from where it stands, in this group of workers, and prints to `out` what differs first, or `verified
 * <n> ticks, hash <16 hex>`; notes go to `notes`. Returns 1 iff nothing differs. */
int verify_run(const verify_recording *recording, fray_world *world, workers_group *group, FILE *out, FILE *notes);

#endif
