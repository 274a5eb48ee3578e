/* SPDX-License-Identifier: Apache-2.0 */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tools/build/number.h"
#include "tools/build/parser.h"

parser_place parser_here(const parser *p) {
  parser_place place = {p->lexer.token.line, p->lexer.token.column};
  return place;
}

int parser_fail(parser *p, parser_place place, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  p->error->line = place.line;
  p->error->column = place.column;
  vsnprintf(p->error->message, sizeof p->error->message, format, arguments);
  va_end(arguments);
  return 0;
}

const char *parser_quote(const token *t, char text[PARSER_FOUND]) {
  enum { SHOWN = 32 };
  int cut = t->bytes > SHOWN;
  if (t->kind == TOKEN_END) {
    snprintf(text, PARSER_FOUND, "the end of the file");
  } else {
    snprintf(text, PARSER_FOUND, "'%.*s%s'", cut ? SHOWN : (int)t->bytes, t->text,
             cut ? "..." : "");
  }
  return text;
}

int parser_expected(parser *p, const char *format, ...) {
  char found[PARSER_FOUND], expected[PARSER_LIST];
  const lexer *l = &p->lexer;
  parser_place place = parser_here(p);
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(expected, sizeof expected, format, arguments);
  va_end(arguments);
  parser_quote(&l->token, found);
  if (l->token.first && l->token.kind != TOKEN_END) {
    snprintf(found, sizeof found, "the end of the line");
    place.line = l->end_line;
    place.column = l->end_column;
  }
  return parser_fail(p, place, "found %s, expected %s", found, expected);
}

int value_here(const parser *p) {
  return p->lexer.token.kind == TOKEN_WORD && !p->lexer.token.first;
}

int value_number_here(const parser *p) {
  exact number;
  size_t used;
  if (p->lexer.token.kind != TOKEN_WORD) return 0;
  return number_read(p->lexer.token.text, p->lexer.token.bytes, &number, &used) != NUMBER_NONE;
}

int value_read_number(parser *p, value_number *value, const char *expected) {
  size_t used;
  char found[PARSER_FOUND];
  if (!value_here(p)) return parser_expected(p, "%s for '%s'", expected, p->key);
  value->token = p->lexer.token;
  number_status status =
      number_read(value->token.text, value->token.bytes, &value->number, &used);
  if (status == NUMBER_NONE) return parser_expected(p, "%s for '%s'", expected, p->key);
  value->token.bytes = used;
  parser_quote(&value->token, found);
  if (status == NUMBER_LONG) {
    return parser_fail(p, parser_here(p), "found %s, expected a number of at most %d digits",
                       found, NUMBER_DIGITS);
  }
  if (status == NUMBER_EXTREME) {
    return parser_fail(p, parser_here(p),
                       "found %s, expected a number that is neither so large nor so small", found);
  }
  lexer_drop(&p->lexer, used);
  return 1;
}

int value_read_unit(parser *p, unit_quantity quantity, exact *factor) {
  const token *t = &p->lexer.token;
  char list[PARSER_LIST] = "";
  *factor = exact_make(1, 1);
  if (quantity == UNIT_NONE) {
    int glued = value_here(p) && t->column == p->lexer.end_column;
    return glued ? parser_expected(p, "nothing behind the plain number for '%s'", p->key) : 1;
  }
  if (value_here(p) && units_find(quantity, t->text, t->bytes, factor)) {
    lexer_next(&p->lexer);
    return 1;
  }
  if (quantity == UNIT_SHARE) return 1;
  units_list(quantity, list, sizeof list);
  return parser_expected(p, "a unit of %s for '%s': %s", units_quantity_name(quantity), p->key,
                         list);
}

static exact limit_of(const char *text, exact factor) {
  exact value;
  size_t used;
  number_read(text, strlen(text), &value, &used);
  return exact_mul(value, factor);
}

int value_scale(parser *p, const value_number *value, exact factor, const value_range *range,
                exact *result) {
  char found[PARSER_FOUND];
  exact range_factor;
  *result = exact_mul(value->number, factor);
  const char *unit = units_of_range(range->quantity, &range_factor);
  int good = exact_valid(*result);
  if (good) {
    good = exact_compare(*result, limit_of(range->least, range_factor)) >= 0 &&
           exact_compare(*result, limit_of(range->most, range_factor)) <= 0;
  }
  if (good) return 1;
  parser_place place = {value->token.line, value->token.column};
  return parser_fail(p, place, "found %s, expected %s to %s%s%s for '%s'",
                     parser_quote(&value->token, found), range->least, range->most,
                     unit[0] != 0 ? " " : "", unit, p->key);
}

/* "a number" or "3 numbers"; of several, which one is missing does not help the reader. */
static const char *numbers_wanted(int count) {
  static const char *const wanted[] = {"a number",  "a number",  "2 numbers",
                                       "3 numbers", "4 numbers", "5 numbers"};
  return wanted[count <= VALUES_MAX ? count : 1];
}

int value_read_exacts(parser *p, const value_range *range, int count, exact *results) {
  value_number values[VALUES_MAX];
  exact factor;
  for (int k = 0; k < count; k++) {
    if (!value_read_number(p, &values[k], numbers_wanted(count))) return 0;
  }
  if (!value_read_unit(p, range->quantity, &factor)) return 0;
  for (int k = 0; k < count; k++) {
    if (!value_scale(p, &values[k], factor, range, &results[k])) return 0;
  }
  return 1;
}

int value_read_count(parser *p, const value_range *range, uint32_t *result) {
  value_number value;
  exact factor, scaled;
  char found[PARSER_FOUND];
  if (!value_read_number(p, &value, "a whole number")) return 0;
  if (!value_read_unit(p, range->quantity, &factor)) return 0;
  if (!value_scale(p, &value, factor, range, &scaled)) return 0;
  if (scaled.denominator != 1 || scaled.numerator < 0 || scaled.numerator > UINT32_MAX) {
    parser_place place = {value.token.line, value.token.column};
    return parser_fail(p, place, "found %s, expected a whole number for '%s'",
                       parser_quote(&value.token, found), p->key);
  }
  *result = (uint32_t)scaled.numerator;
  return 1;
}

int value_read_choice(parser *p, const char *const *choices, int count, int *index) {
  char list[PARSER_LIST] = "";
  for (int k = 0; k < count; k++) {
    if (value_here(p) && lexer_is(&p->lexer.token, choices[k])) {
      lexer_next(&p->lexer);
      *index = k;
      return 1;
    }
    size_t length = strlen(list);
    const char *separator = k == 0 ? "" : k + 1 == count ? " or " : ", ";
    snprintf(list + length, sizeof list - length, "%s%s", separator, choices[k]);
  }
  return parser_expected(p, "%s for '%s'", list, p->key);
}

static int is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

int value_read_name(parser *p, char name[SCENE_NAME]) {
  const token *t = &p->lexer.token;
  if (!value_here(p) || !is_letter(t->text[0])) {
    return parser_expected(p, "a name for '%s' that begins with a letter", p->key);
  }
  for (size_t k = 0; k < t->bytes; k++) {
    char c = t->text[k];
    if (!is_letter(c) && c != '-' && !(c >= '0' && c <= '9')) {
      return parser_expected(p, "a name of letters, digits, _ and - for '%s'", p->key);
    }
  }
  if (t->bytes >= SCENE_NAME) {
    return parser_expected(p, "a name of at most %d characters for '%s'", SCENE_NAME - 1, p->key);
  }
  memcpy(name, t->text, t->bytes);
  name[t->bytes] = 0;
  lexer_next(&p->lexer);
  return 1;
}

int value_read_path(parser *p, char path[SCENE_PATH]) {
  const token *t = &p->lexer.token;
  if (!value_here(p)) return parser_expected(p, "a file for '%s'", p->key);
  const int quoted = t->bytes > 1 && t->text[0] == '"' && t->text[t->bytes - 1] == '"';
  const char *text = t->text + (quoted ? 1 : 0);
  const size_t bytes = t->bytes - (quoted ? 2u : 0u);
  if (bytes == 0 || bytes >= SCENE_PATH || memchr(text, '"', bytes) != NULL)
    return parser_expected(p, "a file of 1 to %d characters without blanks for '%s'", SCENE_PATH - 1,
                           p->key);
  memcpy(path, text, bytes);
  path[bytes] = 0;
  lexer_next(&p->lexer);
  return 1;
}

int value_read_open(parser *p) {
  if (p->lexer.token.kind != TOKEN_OPEN) {
    return parser_expected(p, "'{' behind '%s'", p->key);
  }
  lexer_next(&p->lexer);
  return 1;
}
