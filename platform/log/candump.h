/* SPDX-License-Identifier: Apache-2.0 */
/* Logs of a CAN bus as text, a frame a line: written as `candump -L` does, `(sec.usec6) iface ID#DATA`, and read in
 * the forms of other tools too.
 *
 *   (1436509052.249713) vcan0 044#2A366C2BBA       classic, 11-bit id: 3 hex digits
 *   (1436509052.249713) vcan0 1E5F0A01#0102        29-bit id: 8 hex digits
 *   (1436509052.249713) vcan0 123#R4               remote request, with or without a length
 *   (1436509052.249713) vcan0 123##5AABB           FD: a digit of flags (1 BRS, 2 ESI, 4 FD)
 *   (1436509052.249713) vcan0 20000004#0000000000000000   error frame: bit 29 of 8 digits
 *   (1436509052.249713) can0 044#2A366C2BBA R      python-can, asc2log: R received, T sent
 *     vcan0  123   [8]  11 22 33 44 55 66 77 88    candump; FD: two digits of length, `[08]`
 *    (1436509052.249713)  vcan0  RX - -  123   [2]  11 22   '."'    candump -t a -x -a, log2long
 *     vcan0  123   [4]  remote request             and `20000004   [8]  00 ..   ERRORFRAME`
 *
 * Hex digits are of either case. Lines that begin neither with `(` nor with a space are comments, but for one that
 * begins with CANDUMP_GAP, which is refused: what comes behind it does not follow from what came before. Blank lines
 * are skipped. Everything else is read strictly: a log is evidence. Time may go backwards (several interfaces do
 * that), and is kept to the microsecond; of `candump -t d` it is the time since the line before, which the text does
 * not tell. Hosts only: this file uses libc and the heap. */
#ifndef FRAY_PLATFORM_LOG_CANDUMP_H
#define FRAY_PLATFORM_LOG_CANDUMP_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include "rt/wire/frame.h"

/* Where a recorder had to leave lines out, its log has a line `# gap: N lines are missing here`. */
#define CANDUMP_GAP "# gap: "

enum {
  CANDUMP_LINE_MAX = 512, /* bytes, without the end of line */
  CANDUMP_TEXT = 200      /* bytes that candump_format() needs */
};

#define CANDUMP_NO_TIME INT64_C(-1)

typedef struct {
  int64_t time_us; /* CANDUMP_NO_TIME: the line has none */
  int line; /* from 1 */
  frame frame;
} candump_entry;

typedef struct {
  char file[256];
  int line, column;  /* from 1; 0: not about a place */
  int incomplete;    /* 1: the log is cut off within a line, or has a gap */
  char message[256]; /* what was found, what was expected */
} candump_error;

typedef struct {
  candump_entry *entries; /* in the file's order */
  size_t count;
  size_t others;  /* lines that are no frames, no comments with `#`, and not blank */
  int other_line; /* the first of them; 0: none */
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
 * interface, at most 15 bytes. Hex digits are upper case; an FD frame's flags show FRAME_FD. Without a time
 * it writes 0.
 * Returns the bytes before the 0. */
size_t candump_format(char *text, const char *name, int64_t time_us, const frame *f);

/* The same, to a stream. Returns 0 iff it failed. */
int candump_write(FILE *out, const char *name, int64_t time_us, const frame *f);

/* The line of a gap, as candump_format(). lines: any. */
size_t candump_format_gap(char *text, uint64_t lines);

/* Fills an error; the message is printf-like. Returns 0, for `return candump_fail(...)`. */
#if defined(__GNUC__)
__attribute__((format(printf, 5, 6)))
#endif
int candump_fail(candump_error *error, const char *file, int line, int column,
                 const char *message, ...);

/* `file:line:column: message`, with what is known of the place. */
void candump_print_error(FILE *out, const candump_error *error);

#endif
