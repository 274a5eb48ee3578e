/* SPDX-License-Identifier: Apache-2.0 */
/* A log in which every line is whole. The loop puts lines into a queue of fixed memory and never waits: no system
 * call, no lock. A thread writes the queue out and asks the disk to keep it (fdatasync), every BUS_LOG_EVERY_MS.
 *
 * A power cut loses what was put since the last round began that is on the disk: BUS_LOG_EVERY_MS and the time of
 * a fdatasync, together at most BUS_LOG_LOSS_MS where that takes no longer than the first. On a slower disk a round
 * follows the other, and two of them count; `worst_ns` says what was.
 *
 * A line that finds the queue full is counted and left out. Where that was, the log has a line that begins with
 * CANDUMP_GAP, which no reader of recordings accepts. A write that fails or is cut short goes on where it ended, so a
 * full disk loses no line while the queue has room.
 *
 * Context: bus_log_line() in one thread; the writer is another one, or none is started and that thread calls
 * bus_log_store(). NULL: never. */
#ifndef FRAY_PLATFORM_LINUX_BUS_LOG_H
#define FRAY_PLATFORM_LINUX_BUS_LOG_H

#include <pthread.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>

enum {
  BUS_LOG_BUFFER = 1 << 21, /* bytes: 7 s of two hands at 1 kHz */
  BUS_LOG_EVERY_MS = 50,
  BUS_LOG_LOSS_MS = 100,
  BUS_LOG_TRIES = 100 /* writes of bus_log_end() */
};

typedef struct {
  int fd;              /* or -1: no log */
  uint32_t room;       /* bytes of the queue that are used: BUS_LOG_BUFFER */
  uint64_t lost;       /* lines that are not in the file */
  uint64_t gap;        /* of these, the last ones, behind which no mark stands yet */
  _Atomic uint32_t put, taken; /* bytes since the begin: into the queue, and from it into the file; they wrap */
  _Atomic uint32_t faults;     /* writes and fdatasyncs that failed */
  atomic_int closed;           /* the file is a pipe whose reader has ended */
  int64_t kept_ns;             /* what was put before this time is on the disk; 0: no round yet */
  int64_t worst_ns;            /* the longest that a line was not */
  int is_unsynced;             /* written, without a fdatasync */
  int running;
  atomic_int stop;
  pthread_t writer;
  char buffer[BUS_LOG_BUFFER];
} bus_log;

/* `fd` stays the caller's. Cost: the buffer's pages. */
void bus_log_begin(bus_log *l, int fd);
/* Starts the writer, with ordinary scheduling, on the CPUs of the caller: before the process becomes a real-time
 * one. It takes no signals. Returns 0 iff there is no thread for it. */
int bus_log_start(bus_log *l);
/* One line with its '\n'. Cost: a copy. bytes: 1..CANDUMP_TEXT. */
void bus_log_line(bus_log *l, const char *line, size_t bytes);
/* A round of the writer: writes what is in the queue, then fdatasync. Returns 0 iff something failed. */
int bus_log_store(bus_log *l);
/* Ends the writer and writes the rest of the queue, in BUS_LOG_TRIES rounds at most; what is left then is counted as
 * lost. */
void bus_log_end(bus_log *l);

#endif
