/* SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <string.h>

#include "tools/build/parser.h"

static void list_keys(const block_rule *rule, char *text, size_t capacity) {
  for (int k = 0; k < rule->count; k++) {
    size_t length = strlen(text);
    if (length + 1 >= capacity) return;
    snprintf(text + length, capacity - length, "%s%s", k == 0 ? "" : ", ", rule->keys[k].name);
  }
}

/* A body or another setting of the scene inside a block: most likely a brace was forgotten. */
static int belongs_outside(const token *t) {
  static const char *const words[] = {"scene", "rate", "substeps", "sweeps", "gravity", "seed",
                                      "settle", "rest_strain", "sheet", "ball", "box", "bar", "plane", "mesh",
                                      "pin", "limits", "hands", "triangles", "wind", "load"};
  for (size_t k = 0; k < sizeof words / sizeof words[0]; k++) {
    if (lexer_is(t, words[k])) return 1;
  }
  return 0;
}

static int unknown_key(parser *p, const block_rule *rule, const char *title,
                       parser_place opened) {
  char found[PARSER_FOUND], list[PARSER_LIST] = "";
  const token *t = &p->lexer.token;
  parser_quote(t, found);
  list_keys(rule, list, sizeof list);
  if (opened.line != 0 && belongs_outside(t)) {
    return parser_fail(p, parser_here(p),
                       "found %s in %s; is the '{' of line %d not closed? Its keys: %s", found,
                       title, opened.line, list);
  }
  return parser_fail(p, parser_here(p), "found %s, expected a key of %s: %s", found, title, list);
}

static int read_key(parser *p, const block_rule *rule, const char *title, parser_place opened,
                    void *target, block_seen *seen) {
  int k = 0;
  while (k < rule->count && !lexer_is(&p->lexer.token, rule->keys[k].name)) k++;
  if (k == rule->count) return unknown_key(p, rule, title, opened);
  const block_key *key = &rule->keys[k];
  if (seen->place[k].line != 0 && (key->flags & KEY_REPEATS) == 0) {
    return parser_fail(p, parser_here(p), "found '%s' again in %s, expected it once; see line %d",
                       key->name, title, seen->place[k].line);
  }
  if (seen->place[k].line == 0) seen->place[k] = parser_here(p);
  p->key = key->name;
  p->key_place = parser_here(p);
  lexer_next(&p->lexer);
  return key->read(p, key, target);
}

static int check_needed(parser *p, const block_rule *rule, const char *title, parser_place opened,
                        const block_seen *seen) {
  for (int k = 0; k < rule->count; k++) {
    if ((rule->keys[k].flags & KEY_NEEDED) == 0 || seen->place[k].line != 0) continue;
    parser_place place = opened;
    if (place.line == 0) place.line = place.column = 1;
    return parser_fail(p, place, "%s has no '%s', expected one", title, rule->keys[k].name);
  }
  return 1;
}

int block_read(parser *p, const block_rule *rule, const char *title, parser_place opened,
               void *target, block_seen *seen) {
  memset(seen, 0, sizeof *seen);
  for (;;) {
    token_kind kind = p->lexer.token.kind;
    if (kind == TOKEN_END && opened.line != 0) {
      return parser_fail(p, parser_here(p),
                         "found the end of the file, expected '}' for %s of line %d", title,
                         opened.line);
    }
    if (kind == TOKEN_END) break;
    if (kind == TOKEN_CLOSE && opened.line != 0) {
      lexer_next(&p->lexer);
      break;
    }
    if (kind == TOKEN_CLOSE) {
      return parser_fail(p, parser_here(p), "found '}', expected no brace: no block is open");
    }
    if (!read_key(p, rule, title, opened, target, seen)) return 0;
  }
  return check_needed(p, rule, title, opened, seen);
}

parser_place block_place(const block_rule *rule, const block_seen *seen, const char *name) {
  parser_place nowhere = {0, 0};
  for (int k = 0; k < rule->count; k++) {
    if (strcmp(rule->keys[k].name, name) == 0) return seen->place[k];
  }
  return nowhere;
}

static void *field(const block_key *key, void *target) { return (char *)target + key->offset; }

int block_exacts(parser *p, const block_key *key, void *target) {
  exact results[VALUES_MAX];
  if (!value_read_exacts(p, &key->range, key->count, results)) return 0;
  memcpy(field(key, target), results, sizeof results[0] * (size_t)key->count);
  return 1;
}

int block_count(parser *p, const block_key *key, void *target) {
  uint32_t result;
  if (!value_read_count(p, &key->range, &result)) return 0;
  memcpy(field(key, target), &result, sizeof result);
  return 1;
}

int block_auto_count(parser *p, const block_key *key, void *target) {
  const uint32_t automatic = 0;
  if (value_here(p) && lexer_is(&p->lexer.token, "auto")) {
    lexer_next(&p->lexer);
    memcpy(field(key, target), &automatic, sizeof automatic);
    return 1;
  }
  if (!value_number_here(p) || p->lexer.token.first) {
    return parser_expected(p, "auto or a whole number for '%s'", p->key);
  }
  return block_count(p, key, target);
}
