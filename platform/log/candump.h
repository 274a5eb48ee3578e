/* SPDX-License-Identifier: Apache-2.0 */
/* Logs as `candump -L` writes them: `(sec.usec6) iface ID#DATA`, one frame a line.
 *
 *   (1436509052.249713) vcan0 044#2A366C2BBA       classic, 11-bit id: 3 hex digits
 *   (1436509052.249713) vcan0 1E5F0A01#0102        29-bit id: 8 hex digits
 *   (1436509052.249713) vcan0 123#R4               remote request, with or without a length
 *   (1436509052.249713) vcan0 123##5AABB           FD: a digit of flags (1 BRS, 2 ESI, 4 FD)
 *   (1436509052.249713) vcan0 20000004#0000000000000000   error frame: bit 29 of 8 digits
 *
 * Lines that do not begin with `(` are comments; blank lines are skipped. Everything else is
 * read strictly: a log is evidence. Time may go backwards (several interfaces do that), and is
 * kept to the microsecond. Hosts only: this file uses libc and the heap. */
#ifndef FRAY_LOG_CANDUMP_H
#define FRAY_LOG_CANDUMP_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "rt/wire/frame.h"

enum {
  CANDUMP_LINE_MAX = 512, /* bytes, without the end of line */
  CANDUMP_TEXT = 200      /* bytes that candump_format() needs */
};

typedef struct {
  int64_t time_us;
  int line; /* from 1 */
  frame frame;
} candump_entry;

typedef struct {
  char file[256];
  int line, column;  /* from 1; 0: not about a place */
  char message[256]; /* what was found, what was expected */
} candump_error;

typedef struct {
  candump_entry *entries; /* in the file's order */
  size_t count;
} candump_log;

/* One line without its '\n'. Returns 1: *entry is a frame; 0: nothing in this line; -1: *error
 * says what is wrong (its file is left alone). */
int candump_parse(const char *text, size_t bytes, int line, candump_entry *entry,
                  candump_error *error);

/* A text in memory. Returns 1, or 0 with *error; *log is then empty. `file` is for messages. */
int candump_parse_all(const char *file, const char *text, size_t bytes, candump_log *log,
                      candump_error *error);

/* A whole file. As above. */
int candump_load(const char *file, candump_log *log, candump_error *error);
void candump_free(candump_log *log);

/* Writes one line with its '\n' and a terminating 0 into text[CANDUMP_TEXT]; `name` is the
 * interface, at most 15 bytes. Hex digits are upper case; an FD frame's flags show FRAME_FD.
 * Returns the bytes before the 0. */
size_t candump_format(char *text, const char *name, int64_t time_us, const frame *f);

/* The same, to a stream. Returns 0 iff it failed. */
int candump_write(FILE *out, const char *name, int64_t time_us, const frame *f);

/* Fills an error; the message is printf-like. Returns 0, for `return candump_fail(...)`. */
#if defined(__GNUC__)
__attribute__((format(printf, 5, 6)))
#endif
int candump_fail(candump_error *error, const char *file, int line, int column,
                 const char *message, ...);

/* `file:line:column: message`, with what is known of the place. */
void candump_print_error(FILE *out, const candump_error *error);

#endif
