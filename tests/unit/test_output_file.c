/* SPDX-License-Identifier: Apache-2.0 */
/* A signal at any moment of a file's making leaves the old file, and nothing beside it. */
#define _XOPEN_SOURCE 700

#include "platform/files/output_file.h"

#include <dirent.h>
#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "tests/lib/splitmix64.h"
#include "tests/lib/test.h"

enum { CHILDREN = 1000, LONGEST_NS = 300000 };

static char folder[] = "/tmp/fray_output_XXXXXX";

static void ends(int number) {
  output_file_drop_all();
  _exit(number);
}

static void *write_for_ever(void *name) {
  char path[64];
  snprintf(path, sizeof path, "%s/%s", folder, (const char *)name);
  for (;;)
    if (!output_file_write(path, "whole", 5)) _exit(1);
}

static void child(int threads, int begun) {
  struct sigaction action = {.sa_handler = ends};
  pthread_t other;
  sigfillset(&action.sa_mask);
  (void)sigaction(SIGTERM, &action, NULL);
  if (threads == 2 && pthread_create(&other, NULL, write_for_ever, "b") != 0) _exit(1);
  if (write(begun, "b", 1) != 1) _exit(1);
  (void)write_for_ever("a");
}

/* Files of the folder that are not `a` or `b`, removed. */
static int count_left(void) {
  int left = 0;
  DIR *d = opendir(folder);
  CHECK(d != NULL);
  for (struct dirent *e; d != NULL && (e = readdir(d)) != NULL;) {
    char path[320];
    if (e->d_name[1] == 0 || (e->d_name[0] == '.' && e->d_name[1] == '.' && e->d_name[2] == 0)) continue;
    snprintf(path, sizeof path, "%s/%s", folder, e->d_name);
    (void)unlink(path);
    ++left;
  }
  if (d != NULL) (void)closedir(d);
  return left;
}

/* Not there yet, or all of it. */
static void check_whole(const char *name) {
  char path[64], text[8] = "";
  snprintf(path, sizeof path, "%s/%s", folder, name);
  FILE *in = fopen(path, "rb");
  if (in == NULL) return;
  CHECK_EQ_INT((long long)fread(text, 1, sizeof text, in), 5);
  CHECK_TEXT(text, "whole");
  (void)fclose(in);
}

static void end_at_any_moment(int threads) {
  uint64_t seed = 5;
  int left = 0;
  for (int n = 0; n < CHILDREN; ++n) {
    int ends_of_pipe[2], status = 0;
    char begun = 0;
    CHECK_EQ_INT(pipe(ends_of_pipe), 0);
    const pid_t pid = fork();
    if (pid == 0) child(threads, ends_of_pipe[1]);
    (void)close(ends_of_pipe[1]);
    CHECK(pid > 0);
    if (pid <= 0) return; /* kill() takes -1 for every process */
    CHECK_EQ_INT(read(ends_of_pipe[0], &begun, 1), 1);
    const struct timespec moment = {0, (long)(splitmix64(&seed) % LONGEST_NS)};
    (void)nanosleep(&moment, NULL);
    (void)kill(pid, SIGTERM);
    CHECK_EQ_INT(waitpid(pid, &status, 0), pid);
    (void)close(ends_of_pipe[0]);
    check_whole("a");
    left += count_left();
  }
  CHECK_EQ_INT(left, 0);
}

static void in_one_thread(void) { end_at_any_moment(1); }
static void in_two_threads(void) { end_at_any_moment(2); }

int main(void) {
  CHECK(mkdtemp(folder) != NULL);
  TEST(in_one_thread);
  TEST(in_two_threads);
  char path[64];
  for (const char *name = "ab"; *name != 0; ++name) {
    snprintf(path, sizeof path, "%s/%c", folder, *name);
    (void)unlink(path);
  }
  (void)rmdir(folder);
  return test_end();
}
