/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE

#include "platform/linux/freshness.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "platform/files/output_file.h"
#include "platform/linux/thread.h"
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

/* Replaces the file that was held; -1: none. */
static void hold(freshness *s, int file) {
  if (s->held >= 0) close(s->held);
  s->held = file;
}

/* Whether the file that is held still has the name. */
static int is_in_place(const freshness *s) {
  struct stat held, named;
  return fstat(s->held, &held) == 0 && lstat(s->file, &named) == 0 && held.st_dev == named.st_dev &&
         held.st_ino == named.st_ino;
}

/* Returns 0, or an errno. Never over a file that was put in the place of the one that is held: another end may use it. */
static int store(freshness *s, const uint32_t *values) {
  char text[TEXT];
  output_file out;
  const size_t bytes = format(s, values, text);
  if (!is_in_place(s)) return ESTALE;
  if (!output_file_open(&out, s->file)) return errno;
  const int fresh = fileno(out.stream);
  (void)flock(fresh, LOCK_EX | LOCK_NB); /* a file system without locks is as good as none */
  const int good = fwrite(text, 1, bytes, out.stream) == bytes && fflush(out.stream) == 0 && fsync(fresh) == 0 &&
                   output_file_name(&out);
  int fault = good ? 0 : errno;
  if (out.aside < 0) { /* it has the name, also where its folder could not be synced */
    hold(s, fcntl(fresh, F_DUPFD_CLOEXEC, 0)); /* with its lock */
    if (s->held < 0) fault = errno;
  }
  output_file_drop(&out);
  return fault;
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

/* A file that has no name yet is made here, and nowhere else: of two ends that begin at once, one is refused. */
static int open_held(freshness *s, candump_error *error) {
  const int flags = O_RDWR | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK; /* a pipe of this name has no end */
  s->held = open(s->file, flags);
  if (s->held >= 0) return 1;
  if (errno == ELOOP)
    return candump_fail(error, s->file, 0, 0, "is a symbolic link, expected the file itself, which one end uses");
  if (errno != ENOENT) return candump_fail(error, s->file, 0, 0, "cannot be opened: %s", strerror(errno));
  s->held = open(s->file, flags | O_CREAT | O_EXCL, 0600);
  s->is_new = s->held >= 0;
  return s->is_new || candump_fail(error, s->file, 0, 0, "cannot be written: %s", strerror(errno));
}

static int lock(freshness *s, candump_error *error) {
  struct stat status;
  const int is_anothers = flock(s->held, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  if (is_anothers || !is_in_place(s)) {
    return candump_fail(error, s->file, 0, 0,
                        "another process stores its freshness here, expected that it has ended, or "
                        "a file for each end");
  }
  if (fstat(s->held, &status) != 0 || !S_ISREG(status.st_mode))
    return candump_fail(error, s->file, 0, 0, "is not a regular file, expected a file of freshness");
  if (status.st_nlink > 1) {
    return candump_fail(error, s->file, 0, 0, "has %u names (hard links), expected one, which one end uses",
                        (unsigned)status.st_nlink);
  }
  return 1;
}

static int load(freshness *s, candump_error *error) {
  char text[TEXT];
  if (!open_held(s, error) || !lock(s, error)) return 0;
  if (s->is_new) return 1;
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
    errno = fault;
    return candump_fail(error, s->file, 0, 0, "cannot be written: %s", output_file_reason());
  }
  freshness_exchange(s);
  s->running = thread_start(&s->writer, STACK, run_writer, s);
  return s->running || candump_fail(error, s->file, 0, 0, "no thread for its writer");
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
  if (begin(s, error)) return 1;
  if (s->is_new) (void)unlink(s->file);
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
