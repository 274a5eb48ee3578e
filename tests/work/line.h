/* SPDX-License-Identifier: Apache-2.0 */
/* A line of words and numbers, without a libc. */
#ifndef FRAY_TESTS_WORK_LINE_H
#define FRAY_TESTS_WORK_LINE_H

#include "tests/cross/cases.h"

typedef struct {
  char text[320];
  uint32_t length;
} line;

static inline void line_word(line *l, const char *word) {
  if (l->length > 0) l->text[l->length++] = ' ';
  while (*word != 0 && l->length < sizeof l->text - 3u) l->text[l->length++] = *word++;
}
static inline void line_number(line *l, uint32_t v) {
  char digits[11];
  uint32_t at = 10;
  digits[at] = 0;
  do {
    digits[--at] = (char)('0' + v % 10u);
    v /= 10u;
  } while (v != 0);
  line_word(l, digits + at);
}
static inline line line_begin(const char *what, const char *name) {
  line l;
  l.length = 0;
  line_word(&l, what);
  line_word(&l, name);
  return l;
}
static inline void line_end(line *l) {
  l->text[l->length++] = '\n';
  l->text[l->length] = 0;
  port_print(l->text);
}

#endif
