/* SPDX-License-Identifier: Apache-2.0 */
/* Where the lanes of a guard are, kept in a file across restarts (rt/wire/README.md, "Freshness and
 * resets"). A sender's number in the file is FRESHNESS_AHEAD above its use, and it sends nothing above
 * what is in the file; a receiver's is at most FRESHNESS_EVERY_MS old. A clean end stores both exactly.
 *
 * The loop never touches the file: freshness_exchange() copies a few words, and a thread of its own,
 * made before the process becomes a real-time one, writes FILE.new, fsyncs it, renames it to FILE and
 * fsyncs the folder. So FILE is a whole old one or a whole new one at any moment.
 * It is locked from open to close: an end that is still on its way out would put it back otherwise.
 *
 * The file is a text with the end, form and instance that it is for, and a CMAC under the key over
 * all of it: one of another key, of another end, or that was altered is refused. An old copy put back
 * is not seen. Hosts only. */
#ifndef FRAY_LINUX_FRESHNESS_H
#define FRAY_LINUX_FRESHNESS_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>

#include "platform/log/candump.h"
#include "rt/wire/guard.h"

enum { FRESHNESS_AHEAD = 10000, FRESHNESS_EVERY_MS = 1000, FRESHNESS_PATH = 1024 };

typedef struct {
  guard_lane lane;
  uint32_t end;             /* its highest freshness */
  _Atomic uint32_t used;    /* as of the last exchange */
  _Atomic uint32_t allowed; /* a sender's: what the file says */
  uint32_t seen;            /* the writer's: used, as of the last look */
} freshness_lane;

typedef struct {
  char file[FRESHNESS_PATH], fresh[FRESHNESS_PATH + 4];
  const cmac_key *key;
  const guard *g;
  uint32_t count;
  freshness_lane lanes[GUARD_LANES];
  atomic_int failed; /* errno of the last write, 0: good */
  atomic_int stop;
  int is_new;        /* there was no file */
  int held;          /* FILE as of the last store, locked; -1: none */
  int running;
  pthread_t writer;
} freshness;

/* Sets the lanes of a guard that was just initialised from `file`, writes what is ahead of them, and
 * starts the writer. A file that is not there is made; one that another process stores to is refused.
 * Key and guard must outlive it.
 * Returns 1, or 0 with *error: nothing is running then. */
int freshness_open(freshness *s, const char *file, guard *g, const cmac_key *key,
                   candump_error *error);

/* Once a tick, from the thread of the guard. Cost: a few words. */
void freshness_exchange(freshness *s);

/* 0 while the file can be written. Else an errno: stop soon, in FRESHNESS_AHEAD frames at most no
 * frame can be sent any more. */
int freshness_failed(const freshness *s);

/* Ends the writer and stores where the lanes are. Returns 0 iff that failed. */
int freshness_close(freshness *s);

#endif
