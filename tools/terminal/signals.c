/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L

#include "tools/terminal/signals.h"

#include <signal.h>
#include <stddef.h>
#include <string.h>

static const int numbers[] = {SIGHUP, SIGINT, SIGQUIT, SIGUSR1, SIGUSR2, SIGPIPE, SIGALRM, SIGTERM, SIGXCPU};
enum { NUMBERS = sizeof numbers / sizeof *numbers, DIE = -1 };

static void (*clean_up)(void);
static volatile sig_atomic_t noted = DIE, first;
static volatile int *flag;

static void end_process(int number) {
  sigset_t set;
  if (clean_up != NULL) clean_up();
  (void)signal(number, SIG_DFL);
  (void)sigemptyset(&set);
  (void)sigaddset(&set, number);
  (void)raise(number);
  (void)sigprocmask(SIG_UNBLOCK, &set, NULL);
}

static void take(int number) {
  /* no force depends on a run that is not live: a closed pipe ends it at once */
  const int ends = noted == DIE || (noted == SIGNALS_FIRST && (first != 0 || number == SIGPIPE));
  if (ends) end_process(number);
  if (first == 0) first = number;
  if (flag != NULL) *flag = 1;
}

/* A shell starts what is in the background with SIGINT ignored; a live run takes it all the same. */
static void catch(int is_live) {
  for (int n = 0; n < NUMBERS; ++n) {
    struct sigaction action;
    if (sigaction(numbers[n], NULL, &action) != 0) continue;
    if (action.sa_handler == SIG_IGN && (!is_live || numbers[n] == SIGHUP)) continue;
    memset(&action, 0, sizeof action);
    action.sa_handler = take;
    action.sa_flags = SA_RESTART; /* of writes; sleeps end early all the same */
    (void)sigaction(numbers[n], &action, NULL);
  }
}

void signals_begin(void (*clean)(void)) {
  clean_up = clean;
  (void)signal(SIGXFSZ, SIG_IGN); /* so that the write says it, and the command which file */
  catch(0);
}

void signals_note(signals_noted which, volatile int *seen) {
  noted = (sig_atomic_t)which;
  first = 0;
  flag = seen;
  catch(which == SIGNALS_ALL);
}

int signals_seen(void) { return first; }
