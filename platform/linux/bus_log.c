/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE /* ppoll, in sys.h */

#include "platform/linux/bus_log.h"

#include <inttypes.h>
#include <sched.h>
#include <stdio.h>
#include <string.h>

#include "platform/linux/sys.h"
#include "platform/linux/thread.h"
#include "platform/log/candump.h"

enum { STACK = 1 << 17 };

_Static_assert((BUS_LOG_BUFFER & (BUS_LOG_BUFFER - 1)) == 0, "counts of bytes that wrap find their place by a mask");

void bus_log_begin(bus_log *l, int fd) {
  memset(l, 0, sizeof *l);
  l->fd = fd;
  l->room = BUS_LOG_BUFFER;
}

/* ---- the loop's side ---- */

static void copy_in(bus_log *l, const char *text, uint32_t bytes) {
  const uint32_t put = atomic_load_explicit(&l->put, memory_order_relaxed);
  const uint32_t at = put & (BUS_LOG_BUFFER - 1);
  const uint32_t first = bytes < BUS_LOG_BUFFER - at ? bytes : BUS_LOG_BUFFER - at;
  memcpy(l->buffer + at, text, first);
  memcpy(l->buffer, text + first, bytes - first);
  atomic_store_explicit(&l->put, put + bytes, memory_order_release);
}

static uint32_t room_left(bus_log *l) {
  const uint32_t used = atomic_load(&l->put) - atomic_load_explicit(&l->taken, memory_order_acquire);
  return used < l->room ? l->room - used : 0;
}

/* Where lines were left out, the mark stands before the next one. */
void bus_log_line(bus_log *l, const char *line, size_t bytes) {
  char mark[CANDUMP_TEXT];
  if (l->fd < 0) return;
  const uint32_t gap = l->gap != 0 ? (uint32_t)candump_format_gap(mark, l->gap) : 0;
  if (gap + bytes > room_left(l)) {
    ++l->lost;
    ++l->gap;
    return;
  }
  if (gap != 0) copy_in(l, mark, gap);
  l->gap = 0;
  copy_in(l, line, (uint32_t)bytes);
}

/* ---- the writer's side ---- */

static int64_t now_ns(void) {
  struct timespec now;
  return sys_now(&now) == 0 ? (int64_t)now.tv_sec * 1000000000 + now.tv_nsec : 0;
}

static int write_out(bus_log *l) {
  const uint32_t put = atomic_load_explicit(&l->put, memory_order_acquire);
  for (uint32_t taken = atomic_load(&l->taken); taken != put;) {
    const uint32_t at = taken & (BUS_LOG_BUFFER - 1);
    const uint32_t bytes = put - taken < BUS_LOG_BUFFER - at ? put - taken : BUS_LOG_BUFFER - at;
    const ssize_t written = sys_log(l->fd, l->buffer + at, bytes);
    if (written < 0 && errno == EPIPE) atomic_store(&l->closed, 1);
    if (written <= 0) return 0;
    l->is_unsynced = 1;
    taken += (uint32_t)written;
    atomic_store_explicit(&l->taken, taken, memory_order_release);
  }
  return 1;
}

/* A pipe and some devices have nothing to sync. */
static int sync_out(bus_log *l) {
  if (l->is_unsynced && sys_log_sync(l->fd) != 0 && errno != EINVAL && errno != EROFS) return 0;
  l->is_unsynced = 0;
  return 1;
}

int bus_log_store(bus_log *l) {
  if (l->fd < 0) return 1;
  const int64_t begun_ns = now_ns();
  const int had_lines = atomic_load(&l->put) != atomic_load(&l->taken) || l->is_unsynced;
  const int written = write_out(l);
  if (!sync_out(l) || !written) {
    atomic_fetch_add(&l->faults, 1);
    return 0;
  }
  const int64_t waited_ns = now_ns() - l->kept_ns;
  if (had_lines && l->kept_ns != 0 && waited_ns > l->worst_ns) l->worst_ns = waited_ns;
  l->kept_ns = begun_ns;
  return 1;
}

static void *run_writer(void *context) {
  bus_log *l = context;
  const int64_t every_ns = BUS_LOG_EVERY_MS * INT64_C(1000000);
  while (!atomic_load(&l->stop)) {
    const int64_t begun_ns = now_ns();
    (void)bus_log_store(l);
    const int64_t took_ns = now_ns() - begun_ns;
    const struct timespec pause = {0, (long)(took_ns >= 0 && took_ns < every_ns ? every_ns - took_ns : 1000000)};
    (void)nanosleep(&pause, NULL);
  }
  return NULL;
}

int bus_log_start(bus_log *l) {
  if (l->fd < 0) return 1;
  l->running = thread_start(&l->writer, STACK, run_writer, l);
  return l->running;
}

static void drain(bus_log *l) {
  for (int tries = 0; tries < BUS_LOG_TRIES && !bus_log_store(l); ++tries)
    if (atomic_load(&l->closed)) break;
}

void bus_log_end(bus_log *l) {
  char mark[CANDUMP_TEXT];
  if (l->fd < 0) return;
  atomic_store(&l->stop, 1);
  if (l->running) (void)pthread_join(l->writer, NULL);
  l->running = 0;
  drain(l);
  const uint32_t lines_end = atomic_load(&l->put);
  if (l->gap != 0 && atomic_load(&l->taken) == atomic_load(&l->put)) {
    copy_in(l, mark, (uint32_t)candump_format_gap(mark, l->gap));
    drain(l);
  }
  for (uint32_t n = atomic_load(&l->taken); (int32_t)(lines_end - n) > 0; ++n)
    l->lost += l->buffer[n & (BUS_LOG_BUFFER - 1)] == '\n';
  atomic_store(&l->taken, atomic_load(&l->put));
  l->gap = 0;
}
