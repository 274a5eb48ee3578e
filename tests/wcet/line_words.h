/* SPDX-License-Identifier: Apache-2.0 */
/* A line of words and numbers with a blank between them. */
#ifndef FRAY_TESTS_WCET_LINE_WORDS_H
#define FRAY_TESTS_WCET_LINE_WORDS_H

#define LINE_BYTES 320
#include "tests/determinism/line.h"

static inline void line_gap(line *l) {
  if (l->length > 0) add_text(l, " ");
}
static inline void line_word(line *l, const char *word) {
  line_gap(l);
  add_text(l, word);
}
static inline void line_number(line *l, uint32_t v) {
  line_gap(l);
  add_number(l, v);
}
static inline line line_begin(const char *what, const char *name) {
  line l;
  l.length = 0;
  line_word(&l, what);
  line_word(&l, name);
  return l;
}

#endif
