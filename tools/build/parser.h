/* SPDX-License-Identifier: Apache-2.0 */
/* What the readers of a scene's blocks share. Every function that returns int returns 1, or 0
 * with the error written; the first error ends the parse. */
#ifndef FRAY_BUILD_PARSER_H
#define FRAY_BUILD_PARSER_H

#include "tools/build/lexer.h"
#include "tools/build/scene.h"
#include "tools/build/units.h"

#if defined(__GNUC__)
#define PARSER_PRINTS(text, first) __attribute__((format(printf, text, first)))
#else
#define PARSER_PRINTS(text, first)
#endif

enum { PARSER_FOUND = 48, PARSER_LIST = 320, BLOCK_KEYS = 32, VALUES_MAX = 5 };

typedef struct {
  int line, column; /* line 0: nowhere */
} parser_place;

typedef struct {
  lexer lexer;
  scene *out;
  scene_error *error;
  const char *key;             /* the key whose values are read */
  parser_place key_place;
  parser_place tear_threshold; /* where `tear off` or `tear 5 10 %` stood */
  parser_place tear_mirrored;
  parser_place hand[FRAY_HANDS]; /* where a body took the hand */
} parser;

/* ---- errors: always return 0 ---- */

int parser_fail(parser *p, parser_place place, const char *format, ...) PARSER_PRINTS(3, 4);
/* "found X, expected ...", at the current token. A value must stand on its key's line: the first
 * token of a line counts as the end of the line before. */
int parser_expected(parser *p, const char *format, ...) PARSER_PRINTS(2, 3);

parser_place parser_here(const parser *p);
/* The token in quotes, cut to PARSER_FOUND; returns text. */
const char *parser_quote(const token *t, char text[PARSER_FOUND]);

/* ---- values: the numbers, words and units behind a key ---- */

typedef struct {
  unit_quantity quantity;
  const char *least, *most; /* decimals in units_of_range() */
} value_range;

/* A value as read: the token of its number for messages. */
typedef struct {
  exact number;
  token token;
} value_number;

/* A value may stand here: a token on the key's line that is not a brace. */
int value_here(const parser *p);
/* The current token is a word that begins like a number. */
int value_number_here(const parser *p);
int value_read_number(parser *p, value_number *value, const char *expected);
/* Reads the unit (for shares: if there is one) and gives its factor. */
int value_read_unit(parser *p, unit_quantity quantity, exact *factor);
/* Scales a number into the scene's unit and checks its range. */
int value_scale(parser *p, const value_number *value, exact factor, const value_range *range,
                exact *result);
/* count numbers, at most VALUES_MAX, and their common unit. */
int value_read_exacts(parser *p, const value_range *range, int count, exact *results);
/* A whole number, with its unit if it has one. */
int value_read_count(parser *p, const value_range *range, uint32_t *result);
/* A word of the list, e.g. "top bottom"; *index counts from 0. */
int value_read_choice(parser *p, const char *const *choices, int count, int *index);
/* A letter or _, then letters, digits, _ and -; at most SCENE_NAME - 1. */
int value_read_name(parser *p, char name[SCENE_NAME]);
/* A file: a word, or a word in quotes; at most SCENE_PATH - 1. */
int value_read_path(parser *p, char path[SCENE_PATH]);
int value_read_open(parser *p);

/* ---- blocks: tables of keys ---- */

enum { KEY_NEEDED = 1, KEY_REPEATS = 2 };

typedef struct block_key {
  const char *name;
  int (*read)(parser *p, const struct block_key *key, void *target);
  size_t offset; /* of the field in the target; 0 if read knows it */
  value_range range;
  int count;
  int flags;
} block_key;

typedef struct {
  const block_key *keys;
  int count; /* at most BLOCK_KEYS */
} block_rule;

typedef struct {
  parser_place place[BLOCK_KEYS]; /* of each key's first use; line 0: not used */
} block_seen;

/* Reads keys up to the block's closing brace (or the end of the text iff opened.line is 0) and
 * checks that nothing needed is missing. title names the block in messages, e.g. "ball 'left'". */
int block_read(parser *p, const block_rule *rule, const char *title, parser_place opened,
               void *target, block_seen *seen);
/* Where the key was used. */
parser_place block_place(const block_rule *rule, const block_seen *seen, const char *name);

/* Readers for tables: a field of the target. */
int block_exacts(parser *p, const block_key *key, void *target);
int block_count(parser *p, const block_key *key, void *target);
int block_auto_count(parser *p, const block_key *key, void *target); /* or auto: 0 */

/* ---- the blocks; each reads from behind its keyword ---- */

int sheet_block_read(parser *p, const block_key *key, void *target);
/* Keys that both kinds of sheets have. */
int self_collision_read(parser *p, const block_key *key, void *target);
int self_thickness_read(parser *p, const block_key *key, void *target);
/* triangles { ... }; what it is made of is found once all materials are known. */
int triangles_block_read(parser *p, const block_key *key, void *target);
int triangles_resolve(parser *p);
/* material NAME { ... } */
int material_block_read(parser *p, const block_key *key, void *target);
/* The values of `load`: SIDE X Y Z, a force along a whole side. */
int load_read(parser *p, const block_key *key, void *target);
int body_block_read(parser *p, const block_key *key, void *target);
/* The values of `weave`, into the scene. */
int pattern_read(parser *p, const block_key *key, void *target);
/* The values of `move`, into the scene_body. */
int motion_read(parser *p, const block_key *key, void *target);
/* The values of `pin`; pins_resolve puts them into the grid once it is known. */
int pins_read(parser *p, const block_key *key, void *target);
int pins_resolve(parser *p);
/* The same for `slit`. */
int slits_read(parser *p, const block_key *key, void *target);
int slits_check(parser *p);

#endif
