/* SPDX-License-Identifier: Apache-2.0 */
/* Turns the log of an authenticated bus into a plain one with the frames that its ends have used.
 *
 * CAN FD: POSE, COMMAND, FORCE and ACK with a valid tag, in rising freshness, become their plain form; all
 * others, and every plain one, are removed and reported with their line.
 * Classic CAN: a forged POSE shows only later. TAGs are checked as in the runtime (rt/wire/auth.h); POSEs of
 * a failed lane are removed until a RESET was executed.
 *
 * The start of the log is trusted: a frame of an earlier session, replayed before the first frame of this
 * one, is valid. It can only cause the refusal of a good log. SYNC, TEAR, STATUS and IDENTITY have no
 * tag. */
#ifndef FRAY_TOOLS_RECORDING_UNSEAL_H
#define FRAY_TOOLS_RECORDING_UNSEAL_H

#include <stdint.h>
#include <stdio.h>

#include "platform/log/candump.h"
#include "rt/wire/cmac.h"

/* Counts of a log. */
typedef struct {
  uint32_t good;    /* FD: frames with a valid tag; CLASSIC: valid TAGs */
  uint32_t refused; /* FD: frames removed; CLASSIC: failures, see auth_monitor */
  uint32_t dropped; /* CLASSIC: POSEs removed */
} unseal_counts;

/* 0 plain, 1 CAN FD: most frames of the runtime (or without any, of a device) have a tag. */
int unseal_is_fd(const candump_log *log, uint32_t instance);

/* Notes go to `out` (or NULL), at most 8 lines. */
void unseal_fd(const char *file, candump_log *log, const cmac_key *key, uint32_t instance,
               unseal_counts *counts, FILE *out);
void unseal_classic(const char *file, candump_log *log, const cmac_key *key, uint32_t instance,
                    uint32_t hands, unseal_counts *counts, FILE *out);

/* The whole log. `key_file`: NULL iff there is none; TAGs are then not checked, with a note. Returns 0 after
 * a message to `err`: an authenticated CAN FD log without a key, another key, or a key and no tags. */
int unseal_log(const char *file, candump_log *log, const char *key_file, uint32_t instance,
               uint32_t hands, FILE *err);

#endif
