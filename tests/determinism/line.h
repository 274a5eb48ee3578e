/* SPDX-License-Identifier: Apache-2.0 */
/* Lines of text without a libc, for programs that every machine runs. */
#ifndef FRAY_TESTS_DETERMINISM_LINE_H
#define FRAY_TESTS_DETERMINISM_LINE_H

#include "tests/determinism/cases.h"

#ifndef LINE_BYTES
#define LINE_BYTES 80
#endif

typedef struct {
  char text[LINE_BYTES];
  uint32_t length;
} line;

static inline void add_text(line *l, const char *text) {
  while (*text != 0 && l->length < LINE_BYTES - 2u) l->text[l->length++] = *text++;
}
static inline void add_hex(line *l, uint64_t v, uint32_t digits) {
  char text[17];
  for (uint32_t n = 0; n < digits; ++n)
    text[n] = "0123456789abcdef"[v >> 4u * (digits - 1u - n) & 15u];
  text[digits] = 0;
  add_text(l, text);
}
static inline void add_number(line *l, uint32_t v) {
  char text[11];
  uint32_t at = 10;
  text[at] = 0;
  do {
    text[--at] = (char)('0' + v % 10u);
    v /= 10u;
  } while (v != 0);
  add_text(l, text + at);
}
static inline void print_line(line *l) {
  l->text[l->length++] = '\n';
  l->text[l->length] = 0;
  port_print(l->text);
  l->length = 0;
}

#endif
