/* SPDX-License-Identifier: Apache-2.0 */
/* log_until FILE.log SYNCS COUNT LIKE [AFTER]: sleeps until the log that candump writes has COUNT frames,
 * `ID#DATA`, that match the extended regular expression LIKE, the first that matches AFTER and later ones only.
 * Exit 1 after 5 minutes, or where the log has SYNCS SYNCs more than at first (`-`: any number) and still not
 * that; 2 for wrong use. One process for the whole wait: each that a shell starts costs several ticks. */
#define _POSIX_C_SOURCE 200809L

#include <regex.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { PATIENCE_S = 300, LOOK_NS = 5000000 };

typedef struct {
  regex_t like, after;
  bool begun; /* AFTER was seen, or there is none */
  long wanted, seen, syncs;
} wait_state;

static void take(wait_state *wait, const char *line) {
  char frame[256];
  if (sscanf(line, "(%*[^)]) %*s %255s", frame) != 1) { return; }
  wait->syncs += strncmp(frame, "080#", 4) == 0;
  if (!wait->begun) { wait->begun = regexec(&wait->after, frame, 0, NULL, 0) == 0; }
  wait->seen += wait->begun && regexec(&wait->like, frame, 0, NULL, 0) == 0;
}

/* What has come since; half a line is left for the next time. */
static void read_on(wait_state *wait, FILE *log) {
  char line[512];
  long begun = ftell(log);
  while (wait->seen < wait->wanted && fgets(line, sizeof line, log) != NULL && strchr(line, '\n') != NULL) {
    take(wait, line);
    begun = ftell(log);
  }
  fseek(log, begun, SEEK_SET);
}

int main(int argc, char **argv) {
  if (argc != 5 && argc != 6) {
    fprintf(stderr, "usage: log_until FILE.log SYNCS|- COUNT LIKE [AFTER]\n");
    return 2;
  }
  const long limit = strcmp(argv[2], "-") == 0 ? -1 : strtol(argv[2], NULL, 10);
  const char *after = argv[5];
  wait_state wait = {.begun = after == NULL, .wanted = strtol(argv[3], NULL, 10)};
  FILE *log = fopen(argv[1], "r");
  if (log == NULL || regcomp(&wait.like, argv[4], REG_EXTENDED | REG_NOSUB) != 0 ||
      (after != NULL && regcomp(&wait.after, after, REG_EXTENDED | REG_NOSUB) != 0)) {
    fprintf(stderr, "log_until: cannot open %s, or no regular expression\n", argv[1]);
    return 2;
  }
  read_on(&wait, log);
  const long first_syncs = wait.syncs;
  const time_t began = time(NULL);
  while (wait.seen < wait.wanted && (limit < 0 || wait.syncs < first_syncs + limit) &&
         time(NULL) <= began + PATIENCE_S) {
    nanosleep(&(struct timespec){.tv_nsec = LOOK_NS}, NULL);
    read_on(&wait, log);
  }
  return wait.seen < wait.wanted;
}
