/* SPDX-License-Identifier: Apache-2.0 */
/* Signals that end a command: SIGHUP, SIGINT, SIGQUIT, SIGUSR1, SIGUSR2, SIGPIPE, SIGALRM, SIGTERM, SIGXCPU. Those
 * that the caller of the command ignores stay ignored, in a live run SIGHUP alone (nohup). SIGXFSZ is ignored: a file
 * that grows beyond its limit is one that cannot be written.
 *
 * Context: one thread. */
#ifndef FRAY_TOOLS_TERMINAL_SIGNALS_H
#define FRAY_TOOLS_TERMINAL_SIGNALS_H

/* From now on such a signal calls `clean`, then ends the process as it does by default. */
void signals_begin(void (*clean)(void));

typedef enum {
  SIGNALS_FIRST, /* the first is noted, for a run that ends after a whole tick; the next ends the process */
  SIGNALS_ALL    /* all are noted: forces fade first */
} signals_noted;

/* From now on these signals are noted. `seen`, unless NULL, becomes 1 with the first. */
void signals_note(signals_noted which, volatile int *seen);
/* The first signal that was noted, 0: none. */
int signals_seen(void);

#endif
