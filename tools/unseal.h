/* SPDX-License-Identifier: Apache-2.0 */
/* A log of a bus under a key, made plain: what follows sees what the ends of the bus have used.
 *
 * CAN FD: POSE, COMMAND, FORCE and ACK whose tag fits, in rising freshness, become their plain form;
 * all others, and every plain one, are taken out and named with their line. They are no input.
 * Classic CAN: nothing says beforehand that a POSE is forged. TAGs are checked as the runtime checks
 * them (rt/wire/auth.h); POSEs of a lane that has failed are taken out until a RESET was obeyed.
 *
 * Where the log begins is believed: a frame of an earlier session, replayed before the first frame of
 * this one, fits. It can only make a good log be refused. SYNC, TEAR and STATUS have no tag. */
#ifndef FRAY_TOOLS_UNSEAL_H
#define FRAY_TOOLS_UNSEAL_H

#include <stdint.h>
#include <stdio.h>

#include "platform/log/candump.h"
#include "rt/wire/cmac.h"

/* What stands in a log; lines are kept. */
typedef struct {
  uint32_t good;    /* FD: frames whose tag fits; CLASSIC: TAGs */
  uint32_t refused; /* FD: frames taken out; CLASSIC: failures, see auth_watch */
  uint32_t dropped; /* CLASSIC: POSEs taken out */
} unseal_counts;

/* 0 plain, 1 CAN FD: most of what the runtime said (or if it said nothing, a device) has a tag. */
int unseal_is_fd(const candump_log *log, uint32_t instance);

/* Notes go to `out` (or NULL), at most 8 lines. */
void unseal_fd(const char *file, candump_log *log, const cmac_key *key, uint32_t instance,
               unseal_counts *counts, FILE *out);
void unseal_classic(const char *file, candump_log *log, const cmac_key *key, uint32_t instance,
                    uint32_t hands, unseal_counts *counts, FILE *out);

/* All of it. `key_file`: NULL iff there is none; TAGs are then not checked, which is said. Returns 0
 * after a message to `err`: the log is of CAN FD under a key and there is none, or the key does not
 * fit, or the log has no tags at all. */
int unseal_log(const char *file, candump_log *log, const char *key_file, uint32_t instance,
               uint32_t hands, FILE *err);

#endif
