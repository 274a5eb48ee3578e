/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L
#define _FILE_OFFSET_BITS 64

#include "platform/files/input_file.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FILES_MAX = 64 };

static struct {
  dev_t device;
  ino_t number;
} files[FILES_MAX];
static int file_count;

int input_file_was_read(const struct stat *status) {
  for (int n = 0; n < file_count; ++n)
    if (files[n].device == status->st_dev && files[n].number == status->st_ino) return 1;
  return 0;
}

void input_file_remember(const struct stat *status) {
  if (file_count == FILES_MAX || input_file_was_read(status)) return;
  files[file_count].device = status->st_dev;
  files[file_count++].number = status->st_ino;
}

static void *refuse(char *why, const char *what) {
  snprintf(why, INPUT_FILE_WHY, "%s", what);
  return NULL;
}

static void *refuse_for(char *why, const char *what) {
  snprintf(why, INPUT_FILE_WHY, "%s: %s", what, strerror(errno));
  return NULL;
}

static void *refuse_size(char *why, uint64_t most) {
  snprintf(why, INPUT_FILE_WHY, "has more than %" PRIu64 " MiB, expected a shorter file", most >> 20);
  return NULL;
}

/* NULL: it can be read. */
static const char *unfit(const struct stat *status) {
  if (S_ISREG(status->st_mode) || S_ISFIFO(status->st_mode)) return NULL;
  return S_ISDIR(status->st_mode) ? "cannot be read: it is a folder, expected a file"
                                  : "cannot be read: it is a device or a socket, expected a file";
}

/* Reads to the end of `in`, which is beyond `most` only where that is an error. */
static uint8_t *read_all(int in, uint64_t most, size_t room, size_t *bytes, char *why) {
  uint8_t *data = malloc(room);
  for (*bytes = 0; data != NULL;) {
    const ssize_t n = read(in, data + *bytes, room - 1 - *bytes);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0 || (*bytes += (size_t)n) > most) {
      if (n == 0) return data;
      free(data);
      return n < 0 ? refuse_for(why, "cannot be read") : refuse_size(why, most);
    }
    if (*bytes < room - 1) continue;
    uint8_t *grown = room > SIZE_MAX / 2 ? NULL : realloc(data, room *= 2);
    if (grown == NULL) free(data);
    data = grown;
  }
  return refuse(why, "cannot be read: not enough memory");
}

/* A pipe is opened without waiting for a writer: without one it is at its end at once. */
static uint8_t *read_open(int in, uint64_t most, size_t *bytes, char *why) {
  struct stat status;
  if (fstat(in, &status) != 0) return refuse_for(why, "cannot be read");
  const char *found = unfit(&status);
  if (found != NULL) return refuse(why, found);
  const int is_pipe = S_ISFIFO(status.st_mode);
  if (is_pipe && most > INPUT_FILE_PIPE_MAX) most = INPUT_FILE_PIPE_MAX;
  if (most > SIZE_MAX / 2) most = SIZE_MAX / 2;
  if (!is_pipe && (uint64_t)status.st_size > most) return refuse_size(why, most);
  if (is_pipe && fcntl(in, F_SETFL, 0) != 0) return refuse_for(why, "cannot be read");
  uint8_t *data = read_all(in, most, is_pipe ? 1 << 16 : (size_t)status.st_size + 2, bytes, why);
  if (data != NULL && is_pipe && *bytes == 0) {
    free(data);
    return refuse(why, "cannot be read: it is a pipe without a writer, expected a file");
  }
  if (data == NULL) return NULL;
  data[*bytes] = 0;
  input_file_remember(&status);
  return data;
}

uint8_t *input_file_read(const char *path, uint64_t most, size_t *bytes, char why[INPUT_FILE_WHY]) {
  *bytes = 0;
  const int in = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (in < 0) return refuse_for(why, "cannot be opened");
  uint8_t *data = read_open(in, most, bytes, why);
  (void)close(in);
  return data;
}
