/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/log/candump.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum { SECOND_DIGITS_MAX = 12, NAME_MAX_BYTES = 15 };

/* A place in a line; `bad` is what was expected where it stands. */
typedef struct {
  const char *text;
  size_t bytes, at;
  const char *bad;
} cursor;

static int expect(cursor *c, const char *expected) {
  c->bad = expected;
  return 0;
}

static int take(cursor *c, char wanted, const char *expected) {
  if (c->at == c->bytes || c->text[c->at] != wanted) return expect(c, expected);
  c->at += 1;
  return 1;
}

static int hex_value(char digit) {
  if (digit >= '0' && digit <= '9') return digit - '0';
  if (digit >= 'A' && digit <= 'F') return digit - 'A' + 10;
  if (digit >= 'a' && digit <= 'f') return digit - 'a' + 10;
  return -1;
}

static int peek_hex(const cursor *c) {
  return c->at < c->bytes ? hex_value(c->text[c->at]) : -1;
}

static size_t take_decimal(cursor *c, size_t digits_max, int64_t *value) {
  size_t digits = 0;
  *value = 0;
  while (c->at < c->bytes && digits < digits_max && c->text[c->at] >= '0' &&
         c->text[c->at] <= '9') {
    *value = *value * 10 + (c->text[c->at] - '0');
    c->at += 1;
    digits += 1;
  }
  return digits;
}

static int parse_time(cursor *c, int64_t *time_us) {
  int64_t seconds, micros;
  if (!take(c, '(', "'('")) return 0;
  if (take_decimal(c, SECOND_DIGITS_MAX, &seconds) == 0) {
    return expect(c, "the seconds, 1 to 12 digits");
  }
  if (!take(c, '.', "'.' after the seconds")) return 0;
  if (take_decimal(c, 6, &micros) != 6) return expect(c, "6 digits of microseconds");
  if (!take(c, ')', "')' after 6 digits of microseconds")) return 0;
  *time_us = seconds * 1000000 + micros;
  return take(c, ' ', "one space after the time");
}

static int parse_name(cursor *c) {
  size_t bytes = 0;
  while (c->at < c->bytes && c->text[c->at] > ' ' && c->text[c->at] < 0x7F &&
         bytes < NAME_MAX_BYTES) {
    c->at += 1;
    bytes += 1;
  }
  if (bytes == 0) return expect(c, "the name of an interface");
  return take(c, ' ', "one space after the interface's name (15 characters at most)");
}

static int parse_id(cursor *c, frame *f) {
  const size_t start = c->at;
  uint32_t id = 0;
  while (c->at - start < 8 && peek_hex(c) >= 0) {
    id = id << 4 | (uint32_t)peek_hex(c);
    c->at += 1;
  }
  const size_t digits = c->at - start;
  if (digits != 3 && digits != 8) return expect(c, "an id of 3 or 8 hex digits");
  if (digits == 3 && id > FRAME_ID_MAX) {
    c->at = start;
    return expect(c, "an id of at most 7FF (longer ids have 8 digits)");
  }
  if (id > 0x3FFFFFFFu) {
    c->at = start;
    return expect(c, "an id of at most 1FFFFFFF, or 20000000 and more for an error frame");
  }
  f->extended = digits == 8;
  f->error = (id & 0x20000000u) != 0;
  f->id = id & FRAME_ID_EXTENDED_MAX;
  return take(c, '#', digits == 8 ? "'#' after an id of 8 digits" : "'#' after an id of 3 digits");
}

static int parse_end(cursor *c, const char *expected) {
  return c->at == c->bytes ? 1 : expect(c, expected);
}

static int parse_data(cursor *c, frame *f, size_t most, const char *too_long) {
  size_t bytes = 0;
  while (peek_hex(c) >= 0) {
    if (bytes == most) return expect(c, too_long);
    const int high = peek_hex(c);
    c->at += 1;
    const int low = peek_hex(c);
    if (low < 0) return expect(c, "a second hex digit of this byte");
    c->at += 1;
    f->data[bytes] = (uint8_t)(high << 4 | low);
    bytes += 1;
  }
  f->length = (uint8_t)bytes;
  return parse_end(c, "a hex digit or the end of the line");
}

static int fd_length(size_t bytes) {
  return bytes <= 8 || bytes == 12 || bytes == 16 || bytes == 20 || bytes == 24 || bytes == 32 ||
         bytes == 48 || bytes == 64;
}

static int parse_fd(cursor *c, frame *f) {
  const int flags = peek_hex(c);
  if (flags < 0) return expect(c, "a hex digit of flags after '##'");
  if (flags > 7) return expect(c, "flags of 0 to 7 (1 BRS, 2 ESI, 4 FD)");
  if (f->error) return expect(c, "'#': an error frame is a classic frame");
  c->at += 1;
  f->fd = (uint8_t)(flags | FRAME_FD);
  if (!parse_data(c, f, FRAME_DATA, "the end of the line after 64 bytes")) return 0;
  if (!fd_length(f->length)) return expect(c, "0 to 8, 12, 16, 20, 24, 32, 48 or 64 bytes");
  return 1;
}

static int parse_request(cursor *c, frame *f) {
  if (f->error) return expect(c, "data: an error frame is no remote request");
  c->at += 1;
  f->rtr = 1;
  if (c->at < c->bytes) {
    if (c->text[c->at] < '0' || c->text[c->at] > '8') {
      return expect(c, "the end of the line or a length of 0 to 8 after 'R'");
    }
    f->length = (uint8_t)(c->text[c->at] - '0');
    c->at += 1;
  }
  return parse_end(c, "the end of the line after a remote request");
}

static int parse_frame(cursor *c, candump_entry *entry) {
  frame *f = &entry->frame;
  if (!parse_time(c, &entry->time_us) || !parse_name(c) || !parse_id(c, f)) return 0;
  if (c->at < c->bytes && c->text[c->at] == '#') {
    c->at += 1;
    return parse_fd(c, f);
  }
  if (c->at < c->bytes && c->text[c->at] == 'R') return parse_request(c, f);
  return parse_data(c, f, FRAME_DATA_CLASSIC, "the end of the line after 8 bytes");
}

int candump_parse(const char *text, size_t bytes, int line, candump_entry *entry,
                  candump_error *error) {
  cursor c = {text, bytes, 0, NULL};
  memset(entry, 0, sizeof *entry);
  entry->line = line;
  if (bytes > 0 && text[bytes - 1] == '\r') {
    candump_fail(error, NULL, line, (int)bytes,
                 "found a carriage return, expected a plain line feed (convert with dos2unix)");
    return -1;
  }
  if (bytes > CANDUMP_LINE_MAX) {
    candump_fail(error, NULL, line, CANDUMP_LINE_MAX + 1,
                 "the line is longer than %d bytes, expected its end", CANDUMP_LINE_MAX);
    return -1;
  }
  if (bytes == 0 || text[0] != '(') return 0;
  if (parse_frame(&c, entry)) return 1;
  if (c.at < c.bytes && c.text[c.at] > ' ' && c.text[c.at] < 0x7F) {
    candump_fail(error, NULL, line, (int)c.at + 1, "found '%c', expected %s", c.text[c.at],
                 c.bad);
  } else {
    candump_fail(error, NULL, line, (int)c.at + 1, "found %s, expected %s",
                 c.at == c.bytes          ? "the end of the line"
                 : c.text[c.at] == ' '    ? "a space"
                                          : "a control or non-ASCII character",
                 c.bad);
  }
  return -1;
}

static int log_add(candump_log *log, size_t *room, const candump_entry *entry) {
  if (log->count == *room) {
    const size_t more = *room == 0 ? 1024 : *room * 2;
    candump_entry *grown = more > SIZE_MAX / sizeof *grown
                               ? NULL
                               : realloc(log->entries, more * sizeof *grown);
    if (grown == NULL) return 0;
    log->entries = grown;
    *room = more;
  }
  log->entries[log->count] = *entry;
  log->count += 1;
  return 1;
}

int candump_parse_all(const char *file, const char *text, size_t bytes, candump_log *log,
                      candump_error *error) {
  size_t room = 0;
  size_t start = 0;
  log->entries = NULL;
  log->count = 0;
  for (int line = 1; start < bytes; ++line) {
    const char *end = memchr(text + start, '\n', bytes - start);
    const size_t length = end != NULL ? (size_t)(end - text) - start : bytes - start;
    candump_entry entry;
    const int found = candump_parse(text + start, length, line, &entry, error);
    int good = found >= 0;
    if (good && end == NULL) {
      good = candump_fail(error, file, line, (int)length + 1,
                          "found the end of the file, expected a line feed: the log is cut off");
    }
    if (good && found == 1 && !log_add(log, &room, &entry)) {
      good = candump_fail(error, file, line, 0, "not enough memory for a log of this length");
    }
    if (!good) {
      snprintf(error->file, sizeof error->file, "%s", file);
      candump_free(log);
      return 0;
    }
    start += length + 1;
  }
  return 1;
}

static char *read_all(FILE *in, size_t *bytes) {
  size_t room = 1 << 16;
  char *text = malloc(room);
  *bytes = 0;
  while (text != NULL) {
    *bytes += fread(text + *bytes, 1, room - *bytes, in);
    if (*bytes < room) break;
    char *grown = room > SIZE_MAX / 2 ? NULL : realloc(text, room * 2);
    if (grown == NULL) {
      free(text);
      return NULL;
    }
    text = grown;
    room *= 2;
  }
  if (text != NULL && ferror(in)) {
    free(text);
    return NULL;
  }
  return text;
}

int candump_load(const char *file, candump_log *log, candump_error *error) {
  size_t bytes = 0;
  log->entries = NULL;
  log->count = 0;
  FILE *in = fopen(file, "rb");
  if (in == NULL) return candump_fail(error, file, 0, 0, "cannot be opened: %s", strerror(errno));
  char *text = read_all(in, &bytes);
  fclose(in);
  if (text == NULL) return candump_fail(error, file, 0, 0, "cannot be read");
  const int good = candump_parse_all(file, text, bytes, log, error);
  free(text);
  return good;
}

void candump_free(candump_log *log) {
  free(log->entries);
  log->entries = NULL;
  log->count = 0;
}

size_t candump_format(char *text, const char *name, int64_t time_us, const frame *f) {
  static const char DIGITS[] = "0123456789ABCDEF";
  const uint32_t id = f->error ? f->id | 0x20000000u : f->id;
  int at = snprintf(text, CANDUMP_TEXT, "(%010" PRId64 ".%06" PRId64 ") %.15s %0*" PRIX32 "#",
                    time_us / 1000000, time_us % 1000000, name, f->extended || f->error ? 8 : 3,
                    id);
  if (f->fd) {
    text[at++] = '#';
    text[at++] = DIGITS[(f->fd | FRAME_FD) & 7];
  }
  if (f->rtr) {
    text[at++] = 'R';
    if (f->length > 0) text[at++] = DIGITS[f->length & 15];
  }
  const uint32_t bytes = f->rtr ? 0 : (f->length < FRAME_DATA ? f->length : (uint32_t)FRAME_DATA);
  for (uint32_t n = 0; n < bytes; ++n) {
    text[at++] = DIGITS[f->data[n] >> 4];
    text[at++] = DIGITS[f->data[n] & 15];
  }
  text[at++] = '\n';
  text[at] = 0;
  return (size_t)at;
}

int candump_write(FILE *out, const char *name, int64_t time_us, const frame *f) {
  char text[CANDUMP_TEXT];
  const size_t bytes = candump_format(text, name, time_us, f);
  return fwrite(text, 1, bytes, out) == bytes;
}

int candump_fail(candump_error *error, const char *file, int line, int column,
                 const char *message, ...) {
  va_list arguments;
  memset(error, 0, sizeof *error);
  if (file != NULL) snprintf(error->file, sizeof error->file, "%s", file);
  error->line = line;
  error->column = column;
  va_start(arguments, message);
  vsnprintf(error->message, sizeof error->message, message, arguments);
  va_end(arguments);
  return 0;
}

void candump_print_error(FILE *out, const candump_error *error) {
  fprintf(out, "%s:", error->file);
  if (error->line > 0) fprintf(out, "%d:", error->line);
  if (error->column > 0) fprintf(out, "%d:", error->column);
  fprintf(out, " %s\n", error->message);
}
