/* SPDX-License-Identifier: Apache-2.0 */
#define _XOPEN_SOURCE 700

#include "platform/files/output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "platform/files/input_file.h"

enum { OPEN_MAX_FILES = 16, TRIES = 1000, IN_PLACE = -1 };
enum { SLOT_FREE, SLOT_OPENING, SLOT_NAMED };

/* Names of files that are not whole yet; a signal handler removes those of slots that are NAMED. A thread has no signals
 * while its slot is OPENING: a handler that waits for one is another thread's. */
static char names[OPEN_MAX_FILES][OUTPUT_FILE_PATH];
static atomic_int slots[OPEN_MAX_FILES];
static atomic_int is_ending; /* no thread makes another file, or goes on without one */

/* A thread that goes on beside the handler could end the process before the handler has removed all. */
static void stop_if_ending(void) {
  while (atomic_load(&is_ending) != 0) (void)poll(NULL, 0, -1);
}

static int take_slot(void) {
  for (int n = 0; n < OPEN_MAX_FILES; ++n) {
    int free_slot = SLOT_FREE;
    if (atomic_compare_exchange_strong(&slots[n], &free_slot, SLOT_OPENING)) return n;
  }
  errno = EMFILE;
  return IN_PLACE;
}

/* A new file in the folder of `target`, hidden, whose name nothing has. Returns its descriptor, or -1. */
static int create_aside(const char *target, int slot) {
  const char *slash = strrchr(target, '/');
  const int folder = slash != NULL ? (int)(slash - target + 1) : 0;
  for (int n = 0; n < TRIES; ++n) {
    const int length = snprintf(names[slot], OUTPUT_FILE_PATH, "%.*s.fray-%ld-%d", folder, target, (long)getpid(), n);
    if (length >= OUTPUT_FILE_PATH) {
      errno = ENAMETOOLONG;
      return -1;
    }
    const int fd = open(names[slot], O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (fd >= 0 || errno != EEXIST) return fd;
  }
  errno = EEXIST;
  return -1;
}

/* A file of a slot that is NAMED. Returns its descriptor, or -1. */
static int create_named(output_file *f) {
  sigset_t all, before;
  sigfillset(&all);
  (void)pthread_sigmask(SIG_BLOCK, &all, &before);
  f->aside = take_slot();
  if (atomic_load(&is_ending) != 0) {
    if (f->aside != IN_PLACE) atomic_store(&slots[f->aside], SLOT_FREE);
    stop_if_ending();
  }
  const int fd = f->aside == IN_PLACE ? -1 : create_aside(f->target, f->aside);
  if (f->aside != IN_PLACE) atomic_store(&slots[f->aside], fd < 0 ? SLOT_FREE : SLOT_NAMED);
  (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
  return fd;
}

/* Aside of `target`; `old` is the file that it has, NULL: none. */
static int open_aside(output_file *f, const struct stat *old) {
  const int fd = create_named(f);
  if (fd < 0) return 0;
  if (old != NULL) (void)fchmod(fd, old->st_mode & 0777);
  f->stream = fdopen(fd, "wb");
  if (f->stream != NULL) return 1;
  const int fault = errno;
  (void)close(fd);
  output_file_drop(f);
  errno = fault;
  return 0;
}

/* Where the links of `path` lead, into f->target. */
static int find_target(output_file *f, const char *path) {
  char *found = realpath(path, NULL);
  const int length = snprintf(f->target, sizeof f->target, "%s", found != NULL ? found : path);
  free(found);
  errno = ENAMETOOLONG;
  return length < OUTPUT_FILE_PATH;
}

int output_file_open(output_file *f, const char *path) {
  struct stat old;
  f->stream = NULL;
  f->aside = IN_PLACE;
  if (stat(path, &old) != 0) return find_target(f, path) && open_aside(f, NULL);
  if (S_ISDIR(old.st_mode)) {
    errno = EISDIR;
    return 0;
  }
  if (!S_ISREG(old.st_mode)) return (f->stream = fopen(path, "wb")) != NULL;
  if (input_file_was_read(&old)) {
    errno = EEXIST;
    return 0;
  }
  return access(path, W_OK) == 0 && find_target(f, path) && open_aside(f, &old);
}

static int give_name(output_file *f) {
  if (f->aside == IN_PLACE) return 1;
  if (rename(names[f->aside], f->target) != 0) {
    stop_if_ending(); /* the handler has removed it */
    return 0;
  }
  atomic_store(&slots[f->aside], SLOT_FREE);
  f->aside = IN_PLACE;
  return 1;
}

int output_file_keep(output_file *f) {
  errno = EIO; /* of a write that failed before: its own is gone */
  int good = !ferror(f->stream);
  good = fflush(f->stream) == 0 && good;
  int fault = good ? 0 : errno;
  if (fclose(f->stream) != 0 && fault == 0) fault = errno;
  f->stream = NULL;
  if (fault == 0 && give_name(f)) return 1;
  if (fault == 0) fault = errno;
  output_file_drop(f);
  errno = fault;
  return 0;
}

static int sync_folder(const char *file) {
  char folder[OUTPUT_FILE_PATH];
  const char *slash = strrchr(file, '/');
  snprintf(folder, sizeof folder, "%.*s", slash != NULL ? (int)(slash - file + 1) : 1, slash != NULL ? file : ".");
  const int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return 0;
  const int fault = fsync(fd) == 0 || errno == EINVAL ? 0 : errno; /* EINVAL: a file system that has nothing to sync */
  (void)close(fd);
  errno = fault;
  return fault == 0;
}

int output_file_name(output_file *f) {
  if (f->aside == IN_PLACE) return 1;
  return give_name(f) && sync_folder(f->target);
}

void output_file_drop(output_file *f) {
  if (f->stream != NULL) (void)fclose(f->stream);
  f->stream = NULL;
  if (f->aside == IN_PLACE) return;
  (void)unlink(names[f->aside]);
  atomic_store(&slots[f->aside], SLOT_FREE);
  f->aside = IN_PLACE;
}

int output_file_write(const char *path, const void *data, size_t bytes) {
  output_file f;
  if (!output_file_open(&f, path)) return 0;
  if (fwrite(data, 1, bytes, f.stream) == bytes) return output_file_keep(&f);
  const int fault = errno;
  output_file_drop(&f);
  errno = fault;
  return 0;
}

const char *output_file_reason(void) {
  return errno == EEXIST ? "this command reads it, expected another name" : strerror(errno);
}

void output_file_drop_all(void) {
  atomic_store(&is_ending, 1);
  for (int n = 0; n < OPEN_MAX_FILES; ++n) {
    while (atomic_load(&slots[n]) == SLOT_OPENING) (void)poll(NULL, 0, 1);
    if (atomic_load(&slots[n]) == SLOT_NAMED) (void)unlink(names[n]);
  }
}
