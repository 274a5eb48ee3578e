/* SPDX-License-Identifier: Apache-2.0 */
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tools/scene_language/angle.h"
#include "tools/scene_language/nearest.h"
#include "tools/scene_language/number.h"
#include "tools/scene_language/parser.h"

scene_place parser_here(const parser *p) {
  scene_place place = {p->lexer.token.line, p->lexer.token.column};
  return place;
}

int parser_fail(parser *p, scene_place place, const char *format, ...) {
  va_list arguments;
  va_start(arguments, format);
  p->error->line = place.line;
  p->error->column = place.column;
  vsnprintf(p->error->message, sizeof p->error->message, format, arguments);
  va_end(arguments);
  return 0;
}

const char *parser_quote(const token *t, char text[PARSER_QUOTE]) {
  enum { SHOWN = 32 };
  int cut = t->bytes > SHOWN;
  if (t->kind == TOKEN_END) {
    snprintf(text, PARSER_QUOTE, "the end of the file");
  } else {
    snprintf(text, PARSER_QUOTE, "'%.*s%s'", cut ? SHOWN : (int)t->bytes, t->text,
             cut ? "..." : "");
  }
  return text;
}

void parser_offer(parser *p, const char *word) {
  const token *t = &p->lexer.token;
  const int edits = nearest_edits(t->text, t->bytes, word);
  if (p->near.at != t->text) p->near.word = NULL;
  p->near.at = t->text;
  if (!nearest_is_near(edits, t->bytes) || (p->near.word != NULL && p->near.edits <= edits)) return;
  p->near.word = word;
  p->near.edits = edits;
}

const char *parser_found(const parser *p, char text[PARSER_FOUND]) {
  char quoted[PARSER_QUOTE];
  const int known = p->near.at == p->lexer.token.text && p->near.word != NULL;
  snprintf(text, PARSER_FOUND, known ? "%s (did you mean '%s'?)" : "%s",
           parser_quote(&p->lexer.token, quoted), p->near.word);
  return text;
}

int parser_has_room(parser *p, scene_place place, uint32_t count, uint32_t max, const char *what) {
  return count < max || parser_fail(p, place, "found %s %u, expected at most %u in a scene", what,
                                    (unsigned)count + 1u, (unsigned)max);
}

int parser_expected(parser *p, const char *format, ...) {
  char found[PARSER_FOUND], expected[PARSER_LIST];
  const lexer *l = &p->lexer;
  scene_place place = parser_here(p);
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(expected, sizeof expected, format, arguments);
  va_end(arguments);
  parser_found(p, found);
  if (l->token.first) {
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
  char found[PARSER_QUOTE];
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
  if (value_here(p) && p->lexer.token.text[0] == ',')
    return parser_expected(p, "a point in decimals and blanks between numbers for '%s'", p->key);
  return 1;
}

void value_mark_unit(parser *p, unit_quantity quantity, const char *unit, exact factor) {
  p->mark->quantity = quantity;
  p->mark->unit = unit;
  p->mark->factor = factor;
}

int value_read_unit(parser *p, unit_quantity quantity, exact *factor) {
  const token *t = &p->lexer.token;
  char list[PARSER_LIST] = "";
  *factor = exact_make(1, 1);
  if (quantity == UNIT_NONE) {
    int glued = value_here(p) && t->column == p->lexer.end_column;
    return glued ? parser_expected(p, "nothing behind the plain number for '%s'", p->key) : 1;
  }
  const char *unit = value_here(p) ? units_find(quantity, t->text, t->bytes, factor) : NULL;
  if (unit != NULL || quantity == UNIT_SHARE) {
    value_mark_unit(p, quantity, unit != NULL ? unit : "", *factor);
    if (unit != NULL) lexer_next(&p->lexer);
    return 1;
  }
  const char *near = value_here(p) ? units_near(quantity, t->text, t->bytes) : NULL;
  if (near != NULL) parser_offer(p, near);
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
  char found[PARSER_QUOTE], min_text[NUMBER_TEXT], max_text[NUMBER_TEXT], in_percent[PARSER_QUOTE] = "";
  exact range_factor;
  *result = exact_mul(value->number, factor);
  (void)units_of_range(range->quantity, &range_factor);
  const exact min = limit_of(range->min, range_factor), max = limit_of(range->max, range_factor);
  if (exact_valid(*result) && exact_compare(*result, min) >= 0 && exact_compare(*result, max) <= 0) return 1;
  const scene_place place = {value->token.line, value->token.column};
  const char *unit = range->quantity == UNIT_NONE ? "" : p->mark->unit;
  const char *blank = unit[0] != 0 ? " " : "";
  if (range->quantity == UNIT_SHARE && unit[0] == 0)
    snprintf(in_percent, sizeof in_percent, " (%s to %s %%)", range->min, range->max);
  parser_quote(&value->token, found);
  return parser_fail(p, place, "found %.*s%s%s', expected %s to %s%s%s%s for '%s'", (int)strlen(found) - 1,
                     found, blank, unit, number_write(exact_div(min, factor), 1, min_text),
                     number_write(exact_div(max, factor), -1, max_text), blank, unit, in_percent, p->key);
}

/* "a number" or "3 numbers": which of several is missing does not help the reader. */
static const char *numbers_wanted(int count) {
  static const char *const wanted[] = {"a number",  "a number",  "2 numbers",
                                       "3 numbers", "4 numbers", "5 numbers"};
  return wanted[count <= VALUES_MAX ? count : 1];
}

int value_read_numbers(parser *p, value_number *values, int most) {
  int count = 0;
  do {
    if (!value_read_number(p, &values[count], "a number")) return 0;
    count++;
  } while (count < most && value_here(p) && value_number_here(p));
  return count;
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

int value_read_angle(parser *p, const value_range *range, exact *half_tangent) {
  exact degrees;
  if (!value_read_exacts(p, range, 1, &degrees)) return 0;
  *half_tangent = angle_half_tangent(degrees);
  return exact_valid(*half_tangent) ||
         parser_fail(p, p->key_place, "found an angle of too many digits for '%s', expected fewer", p->key);
}

int value_read_count(parser *p, const value_range *range, uint32_t *result) {
  value_number value;
  exact factor, scaled;
  char found[PARSER_QUOTE];
  if (!value_read_number(p, &value, "a whole number")) return 0;
  if (!value_read_unit(p, range->quantity, &factor)) return 0;
  if (!value_scale(p, &value, factor, range, &scaled)) return 0;
  if (scaled.denominator != 1 || scaled.numerator < 0 || scaled.numerator > UINT32_MAX) {
    scene_place place = {value.token.line, value.token.column};
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
    if (value_here(p)) parser_offer(p, choices[k]);
    size_t length = strlen(list);
    const char *separator = k == 0 ? "" : k + 1 == count ? " or " : ", ";
    snprintf(list + length, sizeof list - length, "%s%s", separator, choices[k]);
  }
  if (value_here(p) && old_word_fails(p, p->key)) return 0;
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
