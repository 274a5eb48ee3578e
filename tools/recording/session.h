/* SPDX-License-Identifier: Apache-2.0 */
/* A world and the log of its inputs, for run, render, bench and verify. */
#ifndef FRAY_TOOLS_RECORDING_SESSION_H
#define FRAY_TOOLS_RECORDING_SESSION_H

#include "tools/world/world_file.h"
#include "tools/recording/replay.h"

typedef struct {
  struct world_file world_file;
  replay log;            /* zeroed iff there is none */
  fray_info facts;      /* before the first tick */
  uint32_t instance;
} session;

typedef struct {
  const char *file; /* NULL: none */
  const char *key;  /* file of the key of an authenticated recording, or NULL */
  int cut;          /* it may end anywhere: log_file_load() */
  uint32_t ticks;   /* of a device log: counts of frames are those of so many ticks; 0: all */
} session_log;

/* Opens a scene or image, and its log. Returns 0, or 2 (the exit code) after a message to stderr; the session is
 * then closed. */
int session_open(session *s, const char *file, const session_log *log, uint32_t instance);
/* The input of the n-th tick; empty after the end of the log. */
const fray_input *session_input(const session *s, uint64_t n);
void session_close(session *s);

#endif
