/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE /* ppoll, in sys.h */

#include "platform/linux/bus_log.h"

#include <string.h>

#include "platform/linux/sys.h"

void bus_log_begin(bus_log *l, int fd) {
  memset(l, 0, sizeof *l);
  l->fd = fd;
  l->write_at = BUS_LOG_WRITE;
}

static void write_some(bus_log *l) {
  const ssize_t written = sys_log(l->fd, l->buffer, l->used);
  if (written < 0) {
    ++l->faults;
    return;
  }
  l->used -= (size_t)written;
  memmove(l->buffer, l->buffer + written, l->used);
}

void bus_log_line(bus_log *l, const char *line, size_t bytes) {
  if (l->fd < 0) return;
  if (l->used >= l->write_at) write_some(l);
  if (bytes > BUS_LOG_BUFFER - l->used) {
    ++l->lost;
    return;
  }
  memcpy(l->buffer + l->used, line, bytes);
  l->used += bytes;
}

void bus_log_end(bus_log *l) {
  if (l->fd < 0) return;
  for (int tries = 0; tries < BUS_LOG_TRIES && l->used > 0; ++tries) write_some(l);
  for (size_t n = 0; n < l->used; ++n) l->lost += l->buffer[n] == '\n';
  l->used = 0;
}
