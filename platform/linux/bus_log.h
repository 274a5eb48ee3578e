/* SPDX-License-Identifier: Apache-2.0 */
/* A log whose lines are whole or not there. Lines wait in a buffer of its own; a write that fails or
 * is cut short is taken up again where it ended, so a full disk or a signal costs no line as long
 * as the buffer lasts. (stdio forgets its buffer when a write fails.) */
#ifndef FRAY_LINUX_BUS_LOG_H
#define FRAY_LINUX_BUS_LOG_H

#include <stddef.h>
#include <stdint.h>

enum {
  BUS_LOG_BUFFER = 1 << 17,
  BUS_LOG_WRITE = 1 << 16,
  BUS_LOG_TRIES = 100 /* writes of bus_log_end() */
};

typedef struct {
  int fd;             /* or -1: no log */
  size_t used;        /* bytes that wait */
  size_t write_at;    /* they are written when so many do; BUS_LOG_WRITE */
  uint64_t lost;      /* lines that are not in the file */
  uint32_t faults;    /* writes that failed */
  char buffer[BUS_LOG_BUFFER];
} bus_log;

/* `fd` stays the caller's. */
void bus_log_begin(bus_log *l, int fd);
/* One line with its '\n'. At most one write. */
void bus_log_line(bus_log *l, const char *line, size_t bytes);
/* Writes what waits, in BUS_LOG_TRIES writes at most; what is left then is counted as lost. */
void bus_log_end(bus_log *l);

#endif
