/* SPDX-License-Identifier: Apache-2.0 */
/* The queue of a live run's log and its writer: putting a line never waits, whatever the file does; what is left out
 * is counted and marked. */
#define _POSIX_C_SOURCE 200809L
#include "platform/linux/bus_log.h"

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "platform/log/candump.h"
#include "tests/lib/test.h"

enum { LINES = 200000, TEXT = 128 };

static bus_log tested;
static char path[] = "/tmp/fray_bus_log_XXXXXX";

static void put_lines(uint32_t from, uint32_t to) {
  char line[TEXT];
  for (uint32_t n = from; n < to; ++n) {
    const int bytes = snprintf(line, sizeof line, "(%010u.000000) vcan0 080#%08X00000000\n", n, (unsigned)n);
    bus_log_line(&tested, line, (size_t)bytes);
  }
}

/* What a file has: whole lines in their order, and marks of gaps that count those between them. */
typedef struct {
  uint32_t next, lines, marked;
  int good;
} found;

static found read_lines(FILE *in) {
  char line[TEXT];
  found f = {0, 0, 0, 1};
  uint32_t gap = 0;
  while (fgets(line, sizeof line, in) != NULL) {
    if (line[strlen(line) - 1] != '\n') f.good = 0;
    if (strncmp(line, CANDUMP_GAP, sizeof CANDUMP_GAP - 1) == 0) {
      gap = (uint32_t)strtoul(line + sizeof CANDUMP_GAP - 1, NULL, 10);
      f.marked += gap;
      continue;
    }
    const uint32_t n = (uint32_t)strtoul(line + 1, NULL, 10);
    if (n != f.next + gap) f.good = 0;
    f.next = n + 1;
    gap = 0;
    ++f.lines;
  }
  return f;
}

static void a_file(void) {
  const int fd = mkstemp(path);
  CHECK(fd >= 0);
  bus_log_begin(&tested, fd);
  CHECK(bus_log_start(&tested));
  put_lines(0, 20000);
  bus_log_end(&tested);
  (void)close(fd);
  FILE *in = fopen(path, "r");
  const found f = read_lines(in);
  (void)fclose(in);
  (void)unlink(path);
  CHECK(f.good);
  CHECK_EQ_INT(f.lines, 20000);
  CHECK_EQ_INT(tested.lost, 0);
  CHECK_EQ_INT(tested.faults, 0);
}

static void *read_pipe(void *context) {
  static found f;
  FILE *in = fdopen(*(int *)context, "r");
  f = read_lines(in);
  (void)fclose(in);
  return &f;
}

/* Nobody reads until all lines are put: one that waited would wait for ever. */
static void a_file_that_stands_still(void) {
  int ends[2];
  pthread_t reader;
  void *result;
  CHECK(pipe(ends) == 0);
  bus_log_begin(&tested, ends[1]);
  CHECK(bus_log_start(&tested));
  put_lines(0, LINES);
  const uint64_t lost = tested.lost;
  CHECK(lost > LINES / 4);
  CHECK(pthread_create(&reader, NULL, read_pipe, &ends[0]) == 0);
  bus_log_end(&tested);
  (void)close(ends[1]);
  (void)pthread_join(reader, &result);
  const found *f = result;
  CHECK(f->good);
  CHECK_EQ_INT(tested.lost, lost);
  CHECK_EQ_INT(f->lines + lost, LINES);
  CHECK_EQ_INT(f->marked, lost);
}

/* Lines before and behind a gap; a reader refuses the log where the gap is. */
static void a_gap_is_refused(void) {
  char text[4096];
  candump_log log;
  candump_error error;
  const int fd = mkstemp(strcpy(path, "/tmp/fray_bus_log_XXXXXX"));
  bus_log_begin(&tested, fd);
  tested.room = 1000;
  put_lines(0, 100);
  CHECK(bus_log_store(&tested));
  put_lines(100, 110);
  bus_log_end(&tested);
  const ssize_t bytes = pread(fd, text, sizeof text, 0);
  (void)close(fd);
  (void)unlink(path);
  CHECK(bytes > 0);
  CHECK_EQ_INT(candump_parse_all("gap.log", text, (size_t)bytes, &log, &error), 0);
  char words[TEXT];
  snprintf(words, sizeof words, "the recording has a gap: %u lines are missing here, the disk was too slow",
           (unsigned)tested.lost);
  CHECK_TEXT(error.message, words);
  CHECK_EQ_INT(error.line, 100 - (int)tested.lost + 1);
}

static void a_closed_pipe(void) {
  int ends[2];
  const struct timespec pause = {0, 10000000};
  CHECK(pipe(ends) == 0);
  (void)close(ends[0]);
  bus_log_begin(&tested, ends[1]);
  CHECK(bus_log_start(&tested));
  put_lines(0, 10);
  for (int n = 0; n < 3000 && !atomic_load(&tested.closed); ++n) (void)nanosleep(&pause, NULL);
  CHECK(atomic_load(&tested.closed));
  bus_log_end(&tested);
  (void)close(ends[1]);
  CHECK_EQ_INT(tested.lost, 10);
}

int main(void) {
  (void)signal(SIGPIPE, SIG_IGN);
  TEST(a_file);
  TEST(a_file_that_stands_still);
  TEST(a_gap_is_refused);
  TEST(a_closed_pipe);
  return test_end();
}
