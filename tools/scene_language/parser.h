/* SPDX-License-Identifier: Apache-2.0 */
/* What the readers of a scene's blocks share. Functions that return int return 1, or 0 with the error
 * written, unless they say otherwise; the first error ends the parse. */
#ifndef FRAY_TOOLS_SCENE_LANGUAGE_PARSER_H
#define FRAY_TOOLS_SCENE_LANGUAGE_PARSER_H

#include "tools/scene_language/lexer.h"
#include "tools/scene_language/scene.h"
#include "tools/scene_language/units.h"

#if defined(__GNUC__)
#define PARSER_PRINTS(text, first) __attribute__((format(printf, text, first)))
#else
#define PARSER_PRINTS(text, first)
#endif

struct block_rule;

enum { PARSER_QUOTE = 48, PARSER_FOUND = 112, PARSER_LIST = 400, BLOCK_KEYS = 32, VALUES_MAX = 5 };

typedef struct {
  lexer lexer;
  scene *out;
  scene_error *error;
  const char *key;                     /* the key of the values that are read */
  scene_place key_place;
  uint32_t block;                      /* of the keys that are read, or about to be */
  source_key *mark;                    /* of the key that is read */
  struct {
    const char *at, *word;             /* the known word that is nearest to the token there */
    int edits;
  } near;
  scene_place tear_threshold;         /* of `tear off` or `tear 5 10 %` */
  scene_place tear_mirrored;
  scene_place hand[FRAY_HANDS];       /* of the body that moves with it */
} parser;

/* ---- errors: always return 0 ---- */

int parser_fail(parser *p, scene_place place, const char *format, ...) PARSER_PRINTS(3, 4);
/* Fails where a scene has max of `what` already. */
int parser_has_room(parser *p, scene_place place, uint32_t count, uint32_t max, const char *what);
/* "found X, expected ...", at the current token. A key and its values share a line: the first token of
 * a line counts as the end of the line before. */
int parser_expected(parser *p, const char *format, ...) PARSER_PRINTS(2, 3);

scene_place parser_here(const parser *p);
/* The token in quotes, cut to PARSER_QUOTE; returns text. */
const char *parser_quote(const token *t, char text[PARSER_QUOTE]);
/* A word that would be good in place of the current token: the nearest one is named in its error. */
void parser_offer(parser *p, const char *word);
/* The current token in quotes, and what may be meant by it; returns text. */
const char *parser_found(const parser *p, char text[PARSER_FOUND]);

/* ---- words of older scenes ---- */

typedef struct {
  const char *where; /* "scene", a block, or the key of a value */
  const char *old, *now;
} old_word;

extern const old_word old_words[];
extern const size_t old_word_count;

/* Returns 1, with the error written, iff the current token is an old word there. */
int old_word_fails(parser *p, const char *where);

/* ---- values: the numbers, words and units behind a key ---- */

typedef struct {
  unit_quantity quantity;
  const char *min, *max; /* decimals in units_of_range() */
} value_range;

/* A value as read: the token of its number for messages. */
typedef struct {
  exact number;
  token token;
} value_number;

/* There is a value: a word on the key's line. */
int value_here(const parser *p);
/* The current token is a word that begins like a number. */
int value_number_here(const parser *p);
int value_read_number(parser *p, value_number *value, const char *expected);
/* The unit's factor; a share may do without a unit. */
int value_read_unit(parser *p, unit_quantity quantity, exact *factor);
/* What the unit of the key's values is, for messages; the readers above do so. */
void value_mark_unit(parser *p, unit_quantity quantity, const char *unit, exact factor);
/* Scales a number into the scene's unit and checks its range. */
int value_scale(parser *p, const value_number *value, exact factor, const value_range *range,
                exact *result);
/* 1 to most numbers; returns how many, or 0. */
int value_read_numbers(parser *p, value_number *values, int most);
/* count numbers, at most VALUES_MAX, and their common unit. */
int value_read_exacts(parser *p, const value_range *range, int count, exact *results);
/* Degrees, as the tangent of half the angle. */
int value_read_angle(parser *p, const value_range *range, exact *half_tangent);
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

#define NO_RANGE {UNIT_NONE, "0", "0"} /* the reader knows */

typedef struct block_rule {
  const char *name; /* of its old words */
  const block_key *keys;
  int count; /* at most BLOCK_KEYS */
} block_rule;

typedef struct {
  scene_place place[BLOCK_KEYS]; /* of each key's first use; line 0: not used */
} block_seen;

/* Reads '{', keys and '}' (the whole scene iff opened.line is 0: keys up to the end of the text) and
 * checks that nothing needed is missing. title names the block in messages, e.g. "sphere 'left'". */
int block_read(parser *p, const block_rule *rule, const char *title, scene_place opened,
               void *target, block_seen *seen);
/* Opens block number `block` for messages: the next block_read() reads it. */
void block_open(parser *p, uint32_t block);
/* Where the key was used. */
scene_place block_place(const block_rule *rule, const block_seen *seen, const char *name);
/* Returns 1 iff the key was used. */
int block_has(const block_rule *rule, const block_seen *seen, const char *name);

/* Readers for tables: a field of the target. */
int block_exacts(parser *p, const block_key *key, void *target);
int block_count(parser *p, const block_key *key, void *target);
int block_auto_count(parser *p, const block_key *key, void *target); /* or auto: 0 */

/* All rules but those of bodies. */
extern const block_rule scene_rule, woven_rule, membrane_rule, material_rule, limits_rule, hands_rule;
/* The rule of a shape, in keys. */
block_rule body_rule_of(fray_shape shape, block_key keys[BLOCK_KEYS]);

/* ---- the blocks and keys of a scene; each reads from behind its keyword ---- */

int woven_block_read(parser *p, const block_key *key, void *target);
/* Its material is found by membrane_block_resolve(), once all materials are known. */
int membrane_block_read(parser *p, const block_key *key, void *target);
int membrane_block_resolve(parser *p);
int material_block_read(parser *p, const block_key *key, void *target);
int body_block_read(parser *p, const block_key *key, void *target);
/* load EDGE X Y Z */
int load_read(parser *p, const block_key *key, void *target);
/* weave, of woven cloth */
int weave_pattern_read(parser *p, const block_key *key, void *target);
/* move, of a scene_body */
int motion_read(parser *p, const block_key *key, void *target);
/* pins_resolve() and slits_check() once the grid is known. */
int pins_read(parser *p, const block_key *key, void *target);
int pins_resolve(parser *p);
int slits_read(parser *p, const block_key *key, void *target);
int slits_check(parser *p);
/* Notes on keys that have no effect where they stand. */
void effects_check(parser *p);

#endif
