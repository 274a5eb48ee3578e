/* SPDX-License-Identifier: Apache-2.0 */
/* A world and the log that drives it: what run, render and verify have in common. */
#ifndef FRAY_TOOLS_SESSION_H
#define FRAY_TOOLS_SESSION_H

#include "tools/open.h"
#include "tools/replay.h"

typedef struct {
  struct opened opened;
  replay log;            /* zeroed iff there is none */
  fray_facts facts;      /* before the first tick */
  uint32_t instance;
} session;

/* Opens a scene or image, and its log if `log` is not NULL; `key` is the key file of a recording
 * under a key, or NULL. Returns 0, or 2 (the exit code) after a message to stderr; the session is
 * then closed. */
int session_open(session *s, const char *file, const char *log, const char *key,
                 uint32_t instance);
/* The input of the n-th tick; nothing behind the end of the log. */
const fray_input *session_input(const session *s, uint32_t n);
void session_close(session *s);

#endif
