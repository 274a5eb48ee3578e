/* SPDX-License-Identifier: Apache-2.0 */
#include "platform/log/candump.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "platform/files/input_file.h"

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

static char peek(const cursor *c) {
  if (c->at == c->bytes) return 0;
  return c->text[c->at];
}

static int take(cursor *c, char wanted, const char *expected) {
  if (c->at == c->bytes || c->text[c->at] != wanted) return expect(c, expected);
  c->at += 1;
  return 1;
}

/* At least one. */
static int take_spaces(cursor *c, const char *expected) {
  if (!take(c, ' ', expected)) return 0;
  while (peek(c) == ' ') c->at += 1;
  return 1;
}

/* Returns 1 iff the word stands here, and passes it. */
static int skip_word(cursor *c, const char *word) {
  const size_t bytes = strlen(word);
  if (c->bytes - c->at < bytes || memcmp(c->text + c->at, word, bytes) != 0) return 0;
  c->at += bytes;
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
  return take_spaces(c, "a space after the time");
}

static int parse_name(cursor *c) {
  size_t bytes = 0;
  while (c->at < c->bytes && c->text[c->at] > ' ' && c->text[c->at] < 0x7F &&
         bytes < NAME_MAX_BYTES) {
    c->at += 1;
    bytes += 1;
  }
  if (bytes == 0) return expect(c, "the name of an interface");
  return take_spaces(c, "a space after the interface's name (15 characters at most)");
}

/* `candump -x`: the direction, then BRS and ESI of an FD frame. */
static int parse_direction(cursor *c, frame *f) {
  if (!skip_word(c, "RX ") && !skip_word(c, "TX ")) return 1;
  static const char *const FLAGS[] = {"- -", "B -", "- E", "B E"};
  for (int n = 0; n < 4; ++n) {
    if (!skip_word(c, FLAGS[n])) continue;
    f->fd = (uint8_t)((n & 1 ? FRAME_FD_BRS : 0) | (n & 2 ? FRAME_FD_ESI : 0));
    return take_spaces(c, "a space after the direction and its flags");
  }
  return expect(c, "'- -', 'B -', '- E' or 'B E' after the direction");
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
  if (peek(c) == '#' || peek(c) == ' ') return 1;
  return expect(c, digits == 8 ? "'#' after an id of 8 digits" : "'#' after an id of 3 digits");
}

/* The end of the line, or ` R` or ` T`: received, sent. */
static int parse_end(cursor *c, const char *expected) {
  if (c->at == c->bytes) return 1;
  if (!take(c, ' ', expected)) return 0;
  if (peek(c) != 'R' && peek(c) != 'T') return expect(c, "'R' or 'T' (received, sent) after the space");
  c->at += 1;
  return c->at == c->bytes ? 1 : expect(c, "the end of the line after the direction");
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

static const char FD_LENGTHS[] = "0 to 8, 12, 16, 20, 24, 32, 48 or 64 bytes";

static int parse_fd(cursor *c, frame *f) {
  const int flags = peek_hex(c);
  if (flags < 0) return expect(c, "a hex digit of flags after '##'");
  if (flags > 7) return expect(c, "flags of 0 to 7 (1 BRS, 2 ESI, 4 FD)");
  if (f->error) return expect(c, "'#': an error frame is a classic frame");
  c->at += 1;
  f->fd = (uint8_t)(flags | FRAME_FD);
  if (!parse_data(c, f, FRAME_DATA, "the end of the line after 64 bytes")) return 0;
  return fd_length(f->length) ? 1 : expect(c, FD_LENGTHS);
}

static int parse_request(cursor *c, frame *f) {
  if (f->error) return expect(c, "data: an error frame is no remote request");
  c->at += 1;
  f->rtr = 1;
  if (c->at < c->bytes && peek(c) != ' ') {
    if (peek(c) < '0' || peek(c) > '8') return expect(c, "the end of the line or a length of 0 to 8 after 'R'");
    f->length = (uint8_t)(c->text[c->at] - '0');
    c->at += 1;
  }
  return parse_end(c, "the end of the line after a remote request");
}

static int parse_compact(cursor *c, frame *f) {
  c->at += 1;
  if (peek(c) == '#') {
    c->at += 1;
    return parse_fd(c, f);
  }
  if (peek(c) == 'R') return parse_request(c, f);
  return parse_data(c, f, FRAME_DATA_CLASSIC, "the end of the line after 8 bytes");
}

/* `[8]`, or `[08]` of an FD frame. */
static int parse_length(cursor *c, frame *f) {
  int64_t length;
  if (!take(c, '[', "'[' and the number of bytes")) return 0;
  const size_t digits = take_decimal(c, 2, &length);
  if (digits == 0) return expect(c, "the number of bytes after '['");
  if (digits == 1 ? length > FRAME_DATA_CLASSIC : !fd_length((size_t)length))
    return expect(c, digits == 1 ? "0 to 8 bytes" : FD_LENGTHS);
  if (digits == 2 && f->error) return expect(c, "one digit of length: an error frame is a classic frame");
  f->fd = (uint8_t)(digits == 2 ? f->fd | FRAME_FD : 0);
  f->length = (uint8_t)length;
  return take(c, ']', "']' after the number of bytes");
}

static int parse_columns_data(cursor *c, frame *f) {
  for (uint32_t n = 0; n < f->length; ++n) {
    if (!(n == 0 ? take_spaces(c, "a space before the data") : take(c, ' ', "a space between two bytes"))) return 0;
    const int high = peek_hex(c);
    if (high < 0) return expect(c, "as many bytes as the length says");
    c->at += 1;
    const int low = peek_hex(c);
    if (low < 0) return expect(c, "a second hex digit of this byte");
    c->at += 1;
    f->data[n] = (uint8_t)(high << 4 | low);
  }
  return 1;
}

/* What `candump` prints without -L. */
static int parse_columns(cursor *c, frame *f) {
  if (!take_spaces(c, "a space after the id") || !parse_length(c, f)) return 0;
  size_t start = c->at;
  while (peek(c) == ' ') c->at += 1;
  if (f->fd == 0 && !f->error && skip_word(c, "remote request")) {
    f->rtr = 1;
    return c->at == c->bytes ? 1 : expect(c, "the end of the line after a remote request");
  }
  c->at = start;
  if (!parse_columns_data(c, f)) return 0;
  while (peek(c) == ' ') c->at += 1;
  if (f->error) (void)skip_word(c, "ERRORFRAME");
  start = c->at;
  if (peek(c) == '\'' && c->bytes - start > 1 && c->text[c->bytes - 1] == '\'') c->at = c->bytes;
  return c->at == c->bytes ? 1 : expect(c, "the end of the line after as many bytes as the length says");
}

static int parse_frame(cursor *c, candump_entry *entry) {
  frame *f = &entry->frame;
  while (peek(c) == ' ') c->at += 1;
  entry->time_us = CANDUMP_NO_TIME;
  if (peek(c) == '(' && !parse_time(c, &entry->time_us)) return 0;
  if (!parse_name(c)) return 0;
  const size_t start = c->at;
  if (!parse_direction(c, f)) return 0;
  const int compact = c->at == start;
  if (!parse_id(c, f)) return 0;
  return compact && peek(c) == '#' ? parse_compact(c, f) : parse_columns(c, f);
}

/* A comment, or only spaces. */
static int has_no_frame(const char *text, size_t bytes) {
  size_t at = 0;
  while (at < bytes && text[at] == ' ') ++at;
  return at == bytes || (at == 0 && text[0] != '(');
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
  const size_t gap = sizeof CANDUMP_GAP - 1;
  if (bytes >= gap && memcmp(text, CANDUMP_GAP, gap) == 0) {
    candump_fail(error, NULL, line, 0, "the recording has a gap: %.*s", (int)(bytes - gap), text + gap);
    error->incomplete = 1;
    return -1;
  }
  if (has_no_frame(text, bytes)) return 0;
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

/* Files of other tools, by how they begin. */
static int refuse_other(const char *file, const char *text, size_t bytes, candump_error *error) {
  static const struct {
    const char *begins, *kind, *converter;
  } KINDS[] = {{";$FILEVERSION", ".trc", "can_logconvert of python-can"},
               {"LOGG", ".blf", "can_logconvert of python-can"},
               {"date ", ".asc", "asc2log or can_logconvert"}};
  for (size_t n = 0; n < sizeof KINDS / sizeof *KINDS; ++n) {
    const size_t length = strlen(KINDS[n].begins);
    if (bytes >= length && memcmp(text, KINDS[n].begins, length) == 0)
      return candump_fail(error, file, 1, 0, "a %s file, expected a log as candump -L writes it: convert it (%s)",
                          KINDS[n].kind, KINDS[n].converter);
  }
  return 1;
}

int candump_parse_all(const char *file, const char *text, size_t bytes, candump_log *log,
                      candump_error *error) {
  size_t room = 0;
  size_t start = 0;
  log->entries = NULL;
  log->count = 0;
  log->others = 0;
  log->other_line = 0;
  if (!refuse_other(file, text, bytes, error)) return 0;
  for (int line = 1; start < bytes; ++line) {
    const char *end = memchr(text + start, '\n', bytes - start);
    const size_t length = end != NULL ? (size_t)(end - text) - start : bytes - start;
    candump_entry entry;
    const int found = candump_parse(text + start, length, line, &entry, error);
    if (found == 0 && length > 0 && text[start] != ' ' && text[start] != '#' && log->others++ == 0)
      log->other_line = line;
    int good = found >= 0;
    if (end == NULL) { /* whatever stands there is not all of it */
      good = candump_fail(error, file, line, (int)length + 1,
                          "found the end of the file, expected a line feed: the log is cut off (--cut takes what is whole)");
      error->incomplete = 1;
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

int candump_load(const char *file, candump_log *log, candump_error *error) {
  char why[INPUT_FILE_WHY];
  size_t bytes = 0;
  log->entries = NULL;
  log->count = 0;
  uint8_t *text = input_file_read(file, INPUT_FILE_LOG_MAX, &bytes, why);
  if (text == NULL) return candump_fail(error, file, 0, 0, "%s", why);
  const int good = candump_parse_all(file, (const char *)text, bytes, log, error);
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
  if (time_us < 0) time_us = 0;
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

size_t candump_format_gap(char *text, uint64_t lines) {
  return (size_t)snprintf(text, CANDUMP_TEXT, CANDUMP_GAP "%" PRIu64 " lines are missing here, the disk was too slow\n",
                          lines);
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
