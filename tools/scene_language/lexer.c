/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/scene_language/lexer.h"

#include <string.h>

int lexer_readable(const char *text, size_t bytes, int *line, int *column, unsigned *byte) {
  size_t line_start = 0;
  *line = 1;
  for (size_t at = 0; at < bytes; at++) {
    unsigned char c = (unsigned char)text[at];
    if (c == '\n') {
      (*line)++;
      line_start = at + 1;
      continue;
    }
    if (c == '\t' || (c >= 0x20 && c <= 0x7e)) continue;
    if (c == '\r' && at + 1 < bytes && text[at + 1] == '\n') continue;
    *column = (int)(at - line_start) + 1;
    *byte = c;
    return 0;
  }
  return 1;
}

static int is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

static void skip_blanks(lexer *l) {
  while (l->at < l->bytes) {
    char c = l->text[l->at];
    if (c == '#') {
      while (l->at < l->bytes && l->text[l->at] != '\n') l->at++;
      continue;
    }
    if (!is_blank(c)) return;
    l->at++;
    if (c == '\n') {
      l->line++;
      l->line_start = l->at;
    }
  }
}

static size_t word_end(const lexer *l) {
  size_t at = l->at;
  while (at < l->bytes) {
    char c = l->text[at];
    if (is_blank(c) || c == '{' || c == '}' || c == '#') break;
    at++;
  }
  return at;
}

static void read_token(lexer *l) {
  int line_before = l->line;
  int at_start = l->at == 0;
  skip_blanks(l);
  token *t = &l->token;
  t->first = at_start || l->line != line_before;
  t->text = l->text + l->at;
  t->line = l->line;
  t->column = (int)(l->at - l->line_start) + 1;
  t->bytes = 0;
  if (l->at == l->bytes) {
    t->kind = TOKEN_END;
    return;
  }
  char c = l->text[l->at];
  if (c == '{' || c == '}') {
    t->kind = c == '{' ? TOKEN_OPEN : TOKEN_CLOSE;
    t->bytes = 1;
  } else {
    t->kind = TOKEN_WORD;
    t->bytes = word_end(l) - l->at;
  }
  l->at += t->bytes;
}

void lexer_start(lexer *l, const char *text, size_t bytes) {
  memset(l, 0, sizeof *l);
  l->text = text;
  l->bytes = bytes;
  l->line = 1;
  l->end_line = 1;
  l->end_column = 1;
  read_token(l);
}

void lexer_next(lexer *l) {
  l->end_line = l->token.line;
  l->end_column = l->token.column + (int)l->token.bytes;
  l->end = (size_t)(l->token.text - l->text) + l->token.bytes;
  read_token(l);
}

void lexer_drop(lexer *l, size_t bytes) {
  token *t = &l->token;
  if (bytes >= t->bytes) {
    lexer_next(l);
    return;
  }
  t->text += bytes;
  t->bytes -= bytes;
  t->column += (int)bytes;
  t->first = 0;
  l->end_line = t->line;
  l->end_column = t->column;
  l->end = (size_t)(t->text - l->text);
}

int lexer_is(const token *t, const char *word) {
  return t->kind == TOKEN_WORD && strlen(word) == t->bytes && memcmp(t->text, word, t->bytes) == 0;
}
