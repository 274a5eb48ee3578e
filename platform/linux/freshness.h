/* SPDX-License-Identifier: Apache-2.0 */
/* The freshness of a gate's lanes, kept in a file across restarts (rt/wire/README.md, "Freshness and
 * resets"). A sender's number in the file is FRESHNESS_AHEAD above its use, and it sends nothing above the
 * number in the file; a receiver's is at most FRESHNESS_EVERY_MS old. A clean end stores both exactly.
 *
 * The loop never touches the file: freshness_exchange() copies a few words, and a thread, started before
 * the process becomes a real-time one, writes a file beside it (output_file.h), fsyncs it, renames it to FILE
 * and fsyncs the folder. So FILE is a whole old one or a whole new one at any moment. It is locked from open
 * to close, so that an end which is still closing cannot overwrite it. It has one name: symbolic and hard
 * links are refused, and a file that is put in its place while it is locked is left alone, as a fault.
 *
 * The file is a text with its end, form and instance, and a CMAC under the key over all of it: a file of
 * another key or another end, or one that was altered, is refused. An old copy that is put back is not
 * detected. Hosts only. */
#ifndef FRAY_PLATFORM_LINUX_FRESHNESS_H
#define FRAY_PLATFORM_LINUX_FRESHNESS_H

#include <pthread.h>
#include <stdatomic.h>
#include <stdint.h>

#include "platform/log/candump.h"
#include "rt/wire/auth_gate.h"

enum { FRESHNESS_AHEAD = 10000, FRESHNESS_EVERY_MS = 1000, FRESHNESS_PATH = 1024 };

typedef struct {
  auth_gate_lane lane;
  uint32_t end;             /* its highest freshness */
  _Atomic uint32_t used;    /* as of the last exchange */
  _Atomic uint32_t allowed; /* of a sender: the number in the file */
  uint32_t seen;            /* the writer's last copy of `used` */
} freshness_lane;

typedef struct {
  char file[FRESHNESS_PATH];
  const cmac_key *key;
  const auth_gate *g;
  uint32_t count;
  freshness_lane lanes[AUTH_GATE_LANES];
  atomic_int failed; /* errno of the last write, 0: good */
  atomic_int stop;
  int is_new;        /* there was no file: this process made it */
  int held;          /* FILE as stored last, locked; -1: none */
  int running;
  pthread_t writer;
} freshness;

/* Sets the lanes of a gate, just initialised, from `file`; stores numbers ahead of them; starts the writer. A
 * missing file is created, and removed where that fails; one that another process has locked is refused. Key and gate must outlive it.
 * Returns 1, or 0 with *error; no thread runs then. */
int freshness_open(freshness *s, const char *file, auth_gate *g, const cmac_key *key,
                   candump_error *error);

/* Call it once a tick, from the gate's thread. Cost: a few words. */
void freshness_exchange(freshness *s);

/* Returns 0 while the file can be written, else an errno: stop soon, since after at most FRESHNESS_AHEAD
 * frames none can be sent any more. */
int freshness_failed(const freshness *s);

/* Ends the writer and stores the lanes exactly. Returns 0 iff that failed. */
int freshness_close(freshness *s);

#endif
