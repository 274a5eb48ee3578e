/* SPDX-License-Identifier: Apache-2.0 */
#include <stdio.h>
#include <string.h>

#include "rt/state/rigid_body.h"
#include "tools/scene_language/parser.h"

static void list_keys(const block_rule *rule, char *text, size_t capacity) {
  for (int k = 0; k < rule->count; k++) {
    size_t length = strlen(text);
    if (length + 1 >= capacity) return;
    snprintf(text + length, capacity - length, "%s%s", k == 0 ? "" : ", ", rule->keys[k].name);
  }
}

static int find_key(const block_rule *rule, const token *t) {
  int k = 0;
  while (k < rule->count && !lexer_is(t, rule->keys[k].name)) k++;
  return k;
}

/* The block that has such a key; NULL: none has. */
static const char *owner_of(const token *t) {
  static const block_rule *const rules[] = {&woven_rule, &membrane_rule, &material_rule, &limits_rule,
                                            &hands_rule};
  block_key keys[BLOCK_KEYS];
  for (size_t n = 0; n < sizeof rules / sizeof rules[0]; n++)
    if (find_key(rules[n], t) < rules[n]->count) return rules[n]->name;
  for (int shape = FRAY_ANCHOR + 1; shape < SHAPES_END; shape++) {
    const block_rule rule = body_rule_of((fray_shape)shape, keys);
    if (find_key(&rule, t) < rule.count) return rule.name;
  }
  return NULL;
}

static int unknown_key(parser *p, const block_rule *rule, const char *title, scene_place opened) {
  char found[PARSER_FOUND], list[PARSER_LIST] = "";
  const token *t = &p->lexer.token;
  if (old_word_fails(p, rule->name)) return 0;
  if (t->bytes > 1 && (memcmp(t->text, "//", 2) == 0 || memcmp(t->text, "/*", 2) == 0))
    return parser_fail(p, parser_here(p), "found '%.2s', expected '#' before a comment", t->text);
  const int outside = opened.line == 0 || find_key(&scene_rule, t) == scene_rule.count;
  const char *owner = outside ? owner_of(t) : NULL;
  if (owner != NULL && strcmp(owner, rule->name) != 0)
    return parser_fail(p, parser_here(p), "found %s in %s, expected it in a block of '%s'",
                       parser_found(p, found), title, owner);
  for (int k = 0; k < rule->count; k++) parser_offer(p, rule->keys[k].name);
  parser_found(p, found);
  list_keys(rule, list, sizeof list);
  /* a key of the scene inside a block: most likely a brace was forgotten */
  if (!outside)
    return parser_fail(p, parser_here(p), "found %s in %s; is the '{' of line %d not closed? Its keys: %s",
                       found, title, opened.line, list);
  return parser_fail(p, parser_here(p), "found %s, expected a key of %s: %s", found, title, list);
}

/* The key's place and text, for messages of the compiler. */
static source_key *begin_key(parser *p, const block_key *key) {
  scene_source *s = &p->out->source;
  source_key *k = &s->keys[s->count];
  if (s->count + 1 < SOURCE_KEYS) s->count++;
  memset(k, 0, sizeof *k);
  k->key = key->name;
  k->block = p->block;
  k->place = parser_here(p);
  return k;
}

/* Up to the end of its line, or a brace. */
static void end_key(const parser *p, source_key *k, size_t begin) {
  size_t bytes = p->lexer.end - begin;
  for (size_t n = 0; n < bytes; n++)
    if (strchr("\r\n{#", p->lexer.text[begin + n]) != NULL) bytes = n;
  while (bytes > 0 && (p->lexer.text[begin + bytes - 1] == ' ' || p->lexer.text[begin + bytes - 1] == '\t'))
    bytes--;
  const int cut = bytes >= SOURCE_SAID;
  snprintf(k->said, SOURCE_SAID, "%.*s%s", cut ? SOURCE_SAID - 4 : (int)bytes, p->lexer.text + begin,
           cut ? "..." : "");
}

void block_open(parser *p, uint32_t block) {
  p->block = block;
  p->out->source.block[block] = p->key_place;
}

static int read_key(parser *p, const block_rule *rule, const char *title, scene_place opened,
                    void *target, block_seen *seen) {
  const int k = find_key(rule, &p->lexer.token);
  if (k == rule->count) return unknown_key(p, rule, title, opened);
  const block_key *key = &rule->keys[k];
  if (seen->place[k].line != 0 && (key->flags & KEY_REPEATS) == 0) {
    return parser_fail(p, parser_here(p), "found '%s' again in %s, expected it once; see line %d",
                       key->name, title, seen->place[k].line);
  }
  if (seen->place[k].line == 0) seen->place[k] = parser_here(p);
  p->key = key->name;
  p->key_place = parser_here(p);
  const size_t begin = (size_t)(p->lexer.token.text - p->lexer.text);
  const uint32_t block = p->block;
  source_key *mark = begin_key(p, key);
  p->mark = mark;
  lexer_next(&p->lexer);
  if (!key->read(p, key, target)) return 0;
  end_key(p, mark, begin);
  p->block = block;
  return 1;
}

static int check_needed(parser *p, const block_rule *rule, const char *title, scene_place opened,
                        const block_seen *seen) {
  for (int k = 0; k < rule->count; k++) {
    if ((rule->keys[k].flags & KEY_NEEDED) == 0 || seen->place[k].line != 0) continue;
    scene_place place = opened;
    if (place.line == 0) place.line = place.column = 1;
    return parser_fail(p, place, "%s has no '%s', expected one", title, rule->keys[k].name);
  }
  return 1;
}

int block_read(parser *p, const block_rule *rule, const char *title, scene_place opened,
               void *target, block_seen *seen) {
  memset(seen, 0, sizeof *seen);
  if (opened.line != 0 && !value_read_open(p)) return 0;
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

scene_place block_place(const block_rule *rule, const block_seen *seen, const char *name) {
  scene_place nowhere = {0, 0};
  for (int k = 0; k < rule->count; k++) {
    if (strcmp(rule->keys[k].name, name) == 0) return seen->place[k];
  }
  return nowhere;
}

int block_has(const block_rule *rule, const block_seen *seen, const char *name) {
  return block_place(rule, seen, name).line != 0;
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
