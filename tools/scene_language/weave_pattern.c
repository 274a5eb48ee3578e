/* SPDX-License-Identifier: Apache-2.0 */
/* The repeat of a weave. */
#include <stdio.h>
#include <string.h>

#include "tools/scene_language/parser.h"

/* A warp passes over `over` wefts and under `under`; the diagonal rises to the right. */
static void fill_twill(scene *out, uint32_t over, uint32_t under) {
  uint32_t repeat = over + under;
  out->woven.weave_columns = out->woven.weave_rows = repeat;
  for (uint32_t row = 0; row < repeat; row++) {
    for (uint32_t column = 0; column < repeat; column++) {
      out->woven.weave[row][column] = (row + column) % repeat < over;
    }
  }
}

/* Each warp passes under one weft in the repeat, and no two of these crossings are neighbours. */
static void fill_satin(scene *out, uint32_t repeat) {
  uint32_t step = repeat == 8 ? 3 : 2;
  out->woven.weave_columns = out->woven.weave_rows = repeat;
  for (uint32_t row = 0; row < repeat; row++) {
    for (uint32_t column = 0; column < repeat; column++) {
      out->woven.weave[row][column] = column != row * step % repeat;
    }
  }
}

static uint32_t digit_of(char c) { return c >= '0' && c <= '9' ? (uint32_t)(c - '0') : 0; }

/* One word, e.g. "2/1". */
static int read_twill(parser *p, scene *out) {
  const token *t = &p->lexer.token;
  uint32_t over = 0, under = 0;
  if (value_here(p) && t->bytes == 3 && t->text[1] == '/') {
    over = digit_of(t->text[0]);
    under = digit_of(t->text[2]);
  }
  if (over < 1 || under < 1 || over + under > SCENE_WEAVE) {
    return parser_expected(p, "a twill such as 2/1, of %d yarns at most", SCENE_WEAVE);
  }
  fill_twill(out, over, under);
  snprintf(out->woven.weave_name, SCENE_NAME, "twill %u/%u", (unsigned)over, (unsigned)under);
  lexer_next(&p->lexer);
  return 1;
}

static int read_satin(parser *p, scene *out) {
  static const char *const repeats[] = {"5", "7", "8"};
  static const uint32_t values[] = {5, 7, 8};
  int index;
  if (!value_read_choice(p, repeats, 3, &index)) return 0;
  fill_satin(out, values[index]);
  snprintf(out->woven.weave_name, SCENE_NAME, "satin %s", repeats[index]);
  return 1;
}

static int read_matrix_row(parser *p, scene *out, uint32_t row) {
  const token *t = &p->lexer.token;
  p->lexer.token.first = 0; /* a row may begin a line */
  if (row >= SCENE_WEAVE) {
    return parser_expected(p, "'}': a weave has at most %d rows", SCENE_WEAVE);
  }
  if (t->bytes > SCENE_WEAVE || (row > 0 && t->bytes != out->woven.weave_columns)) {
    unsigned min = row > 0 ? (unsigned)out->woven.weave_columns : 1u;
    unsigned max = row > 0 ? min : (unsigned)SCENE_WEAVE;
    return parser_expected(p, "a row of the weave with %u to %u digits", min, max);
  }
  for (size_t column = 0; column < t->bytes; column++) {
    char c = t->text[column];
    if (c != '0' && c != '1') {
      return parser_expected(p, "a row of the weave: 1 where the warp is over, 0 where under");
    }
    out->woven.weave[row][column] = c == '1';
  }
  out->woven.weave_columns = (uint32_t)t->bytes;
  lexer_next(&p->lexer);
  return 1;
}

static int read_matrix(parser *p, scene *out) {
  uint32_t rows = 0;
  scene_place opened = parser_here(p);
  if (!value_read_open(p)) return 0;
  while (p->lexer.token.kind == TOKEN_WORD) {
    if (!read_matrix_row(p, out, rows)) return 0;
    rows++;
  }
  if (p->lexer.token.kind != TOKEN_CLOSE || rows == 0) {
    p->lexer.token.first = 0;
    return parser_expected(p, "%s for the weave's '{' of line %d",
                           rows == 0 ? "rows of 0 and 1" : "'}'", opened.line);
  }
  lexer_next(&p->lexer);
  out->woven.weave_rows = rows;
  snprintf(out->woven.weave_name, SCENE_NAME, "matrix");
  return 1;
}

int weave_pattern_read(parser *p, const block_key *key, void *target) {
  static const char *const kinds[] = {"plain", "twill", "satin", "matrix"};
  scene *out = (scene *)target;
  int kind;
  (void)key;
  if (!value_read_choice(p, kinds, 4, &kind)) return 0;
  memset(out->woven.weave, 0, sizeof out->woven.weave);
  if (kind == 1) return read_twill(p, out);
  if (kind == 2) return read_satin(p, out);
  if (kind == 3) return read_matrix(p, out);
  fill_twill(out, 1, 1);
  snprintf(out->woven.weave_name, SCENE_NAME, "plain");
  return 1;
}
