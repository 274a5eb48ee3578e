/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE

#include "platform/linux/freshness.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "rt/base/bytes.h"

enum { TEXT = 1024, POLL_MS = 50, STACK = 1 << 17 };

/* Above this a sender's store is due at once. */
enum { NEAR = FRESHNESS_AHEAD / 2 };

static uint32_t sum_up_to(uint32_t a, uint32_t b, uint32_t max) {
  return b > max || a > max - b ? max : a + b;
}

/* The text names its end, form and instance; `values` are the numbers of the lanes, in order. */
static size_t format(const freshness *s, const uint32_t *values, char text[TEXT]) {
  uint8_t tag[CMAC_BLOCK];
  size_t at = (size_t)snprintf(text, TEXT, "fray freshness 1\n%s %s instance %u\n",
                               s->g->end == AUTH_GATE_RUNTIME ? "runtime" : "device",
                               s->g->form == AUTH_GATE_FD ? "fd" : "classic", s->g->instance);
  for (uint32_t n = 0; n < s->count; ++n)
    at += (size_t)snprintf(text + at, TEXT - at, "%s %03X %u\n",
                           s->lanes[n].lane.sends ? "sent" : "accepted",
                           dictionary_id(s->lanes[n].lane.message, s->g->instance), values[n]);
  cmac_tag(s->key, (const uint8_t *)text, (uint32_t)at, tag);
  at += (size_t)snprintf(text + at, TEXT - at, "tag ");
  for (uint32_t n = 0; n < CMAC_BLOCK; ++n)
    at += (size_t)snprintf(text + at, TEXT - at, "%02X", tag[n]);
  at += (size_t)snprintf(text + at, TEXT - at, "\n");
  return at;
}

static int write_all(int out, const char *text, size_t bytes) {
  while (bytes > 0) {
    const ssize_t written = write(out, text, bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return 0;
    text += written;
    bytes -= (size_t)written;
  }
  return fsync(out) == 0;
}

static int sync_folder(const char *file) {
  char folder[FRESHNESS_PATH];
  const char *slash = strrchr(file, '/');
  snprintf(folder, sizeof folder, "%.*s", slash == NULL ? 1 : (int)(slash - file + 1),
           slash == NULL ? "." : file);
  const int in = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (in < 0) return 0;
  const int good = fsync(in) == 0 || errno == EINVAL; /* a file system that has nothing to sync */
  close(in);
  return good;
}

/* Replaces the file that was held; -1: none. */
static void hold(freshness *s, int file) {
  if (s->held >= 0) close(s->held);
  s->held = file;
}

/* A file that lost its name since it was opened was replaced by another process that stores. */
static int is_anothers(int file) {
  struct stat status;
  if (flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return 1;
  return fstat(file, &status) == 0 && status.st_nlink == 0;
}

/* Returns 0, or an errno. What has the name of the new file, left behind or put there, is removed and never written
 * through. */
static int store(freshness *s, const uint32_t *values) {
  char text[TEXT];
  const size_t bytes = format(s, values, text);
  if (unlink(s->fresh) != 0 && errno != ENOENT) return errno;
  const int out = open(s->fresh, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (out < 0) return errno;
  (void)flock(out, LOCK_EX | LOCK_NB); /* a file system without locks is as good as none */
  errno = EIO;
  if (!write_all(out, text, bytes) || rename(s->fresh, s->file) != 0) {
    const int fault = errno;
    close(out);
    return fault;
  }
  hold(s, out);
  errno = EIO;
  return sync_folder(s->file) ? 0 : errno;
}

/* The numbers to store now; once they are stored, the limits of the senders. */
static int store_ahead(freshness *s) {
  uint32_t values[AUTH_GATE_LANES];
  for (uint32_t n = 0; n < s->count; ++n) {
    const uint32_t used = atomic_load(&s->lanes[n].used);
    values[n] = s->lanes[n].lane.sends ? sum_up_to(used, FRESHNESS_AHEAD, s->lanes[n].end) : used;
  }
  const int fault = store(s, values);
  for (uint32_t n = 0; n < s->count && fault == 0; ++n)
    if (s->lanes[n].lane.sends) atomic_store(&s->lanes[n].allowed, values[n]);
  atomic_store(&s->failed, fault);
  return fault;
}

static int is_due(const freshness *s) {
  for (uint32_t n = 0; n < s->count; ++n) {
    const uint32_t allowed = atomic_load(&s->lanes[n].allowed);
    if (s->lanes[n].lane.sends && allowed != s->lanes[n].end &&
        atomic_load(&s->lanes[n].used) > allowed - NEAR)
      return 1;
  }
  return 0;
}

static int has_moved(freshness *s) {
  int moved = 0;
  for (uint32_t n = 0; n < s->count; ++n) {
    const uint32_t used = atomic_load(&s->lanes[n].used);
    moved |= used != s->lanes[n].seen;
    s->lanes[n].seen = used;
  }
  return moved;
}

static void *run_writer(void *context) {
  freshness *s = context;
  const struct timespec pause = {0, POLL_MS * 1000000L};
  for (int waited_ms = 0; !atomic_load(&s->stop); waited_ms += POLL_MS) {
    (void)nanosleep(&pause, NULL);
    const int due = is_due(s);
    if (waited_ms < FRESHNESS_EVERY_MS && !due) continue;
    waited_ms = 0;
    if (has_moved(s) || due || atomic_load(&s->failed) != 0) (void)store_ahead(s);
  }
  return NULL;
}

/* The thread blocks all signals: they are the loop's. A small stack, since a real-time process locks it. */
static int start_writer(freshness *s) {
  pthread_attr_t attributes;
  sigset_t all, before;
  sigfillset(&all);
  if (pthread_attr_init(&attributes) != 0) return 0;
  (void)pthread_attr_setstacksize(&attributes, STACK);
  (void)pthread_sigmask(SIG_BLOCK, &all, &before);
  s->running = pthread_create(&s->writer, &attributes, run_writer, s) == 0;
  (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
  (void)pthread_attr_destroy(&attributes);
  return s->running;
}

/* Reads the numbers at the places where format() writes them; the whole text must equal format()'s. */
static int parse(freshness *s, const char *text, size_t bytes, candump_error *error) {
  uint32_t values[AUTH_GATE_LANES] = {0};
  char again[TEXT];
  const char *at = text;
  for (uint32_t n = 0; n < s->count + 1; ++n) {
    at = strchr(at, '\n');
    if (at == NULL)
      return candump_fail(error, s->file, 0, 0,
                          "not a file of freshness, expected one that --freshness wrote, or none");
    at += 1;
    const char *end = strchr(at, '\n');
    const char *number = end;
    while (number != NULL && number > at && number[-1] != ' ') --number;
    if (n > 0 && number != NULL) values[n - 1] = (uint32_t)strtoul(number, NULL, 10);
  }
  const size_t wanted = format(s, values, again);
  if (bytes == wanted && memcmp(text, again, bytes) == 0) {
    for (uint32_t n = 0; n < s->count; ++n) *s->lanes[n].lane.last = values[n];
    return 1;
  }
  const char *line = strchr(again, '\n') + 1;
  const size_t head = (size_t)(strchr(line, '\n') - again);
  if (bytes < head || memcmp(text, again, head) != 0) {
    return candump_fail(error, s->file, 2, 0, "not of this end of the bus, expected '%.*s'",
                        (int)(head - (size_t)(line - again)), line);
  }
  return candump_fail(error, s->file, 0, 0,
                      "was written under another key, or altered; expected the key that it was "
                      "written under, or for a key that is new everywhere another file");
}

static int load(freshness *s, candump_error *error) {
  char text[TEXT];
  s->held = open(s->file, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe of this name has no end */
  if (s->held < 0 && errno == ENOENT) {
    s->is_new = 1;
    return 1;
  }
  if (s->held < 0) {
    return candump_fail(error, s->file, 0, 0, "cannot be opened: %s", strerror(errno));
  }
  if (is_anothers(s->held)) {
    return candump_fail(error, s->file, 0, 0,
                        "another process stores its freshness here, expected that it has ended, or "
                        "a file for each end");
  }
  const ssize_t bytes = read(s->held, text, sizeof text - 1);
  if (bytes < 0) return candump_fail(error, s->file, 0, 0, "cannot be read: %s", strerror(errno));
  text[bytes] = 0;
  return parse(s, text, (size_t)bytes, error);
}

static int check_lanes(freshness *s, candump_error *error) {
  for (uint32_t n = 0; n < s->count; ++n) {
    freshness_lane *l = &s->lanes[n];
    const uint32_t last = *l->lane.last;
    atomic_init(&l->used, last);
    atomic_init(&l->allowed, last);
    l->seen = last;
    if (last > l->end || (l->lane.sends && last == l->end)) {
      return candump_fail(error, s->file, 0, 0,
                          "no freshness is left under this key, expected a new key and a new file");
    }
  }
  return 1;
}

static int begin(freshness *s, candump_error *error) {
  if (!load(s, error) || !check_lanes(s, error)) return 0;
  const int fault = store_ahead(s);
  if (fault != 0) {
    return candump_fail(error, s->file, 0, 0, "cannot be written: %s", strerror(fault));
  }
  freshness_exchange(s);
  return start_writer(s) || candump_fail(error, s->file, 0, 0, "no thread for its writer");
}

int freshness_open(freshness *s, const char *file, auth_gate *g, const cmac_key *key,
                   candump_error *error) {
  auth_gate_lane lanes[AUTH_GATE_LANES];
  memset(s, 0, sizeof *s);
  s->held = -1;
  s->key = key;
  s->g = g;
  s->count = auth_gate_lanes(g, lanes);
  for (uint32_t n = 0; n < s->count; ++n) {
    s->lanes[n].lane = lanes[n];
    s->lanes[n].end = *lanes[n].max;
  }
  if ((size_t)snprintf(s->file, sizeof s->file, "%s", file) >= sizeof s->file) {
    return candump_fail(error, "", 0, 0, "the name of the file of freshness is too long");
  }
  snprintf(s->fresh, sizeof s->fresh, "%s.new", s->file);
  if (begin(s, error)) return 1;
  hold(s, -1);
  return 0;
}

void freshness_exchange(freshness *s) {
  for (uint32_t n = 0; n < s->count; ++n) {
    freshness_lane *l = &s->lanes[n];
    atomic_store(&l->used, *l->lane.last);
    if (l->lane.sends) *l->lane.max = atomic_load(&l->allowed);
  }
}

int freshness_failed(const freshness *s) { return atomic_load(&s->failed); }

int freshness_close(freshness *s) {
  uint32_t values[AUTH_GATE_LANES];
  if (!s->running) return 1;
  atomic_store(&s->stop, 1);
  (void)pthread_join(s->writer, NULL);
  s->running = 0;
  for (uint32_t n = 0; n < s->count; ++n) values[n] = *s->lanes[n].lane.last;
  const int fault = store(s, values);
  hold(s, -1);
  if (fault != 0) atomic_store(&s->failed, fault);
  return fault == 0;
}
