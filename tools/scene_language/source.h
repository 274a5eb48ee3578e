/* SPDX-License-Identifier: Apache-2.0 */
/* Where the keys of a scene stand in its text and how their values are written: what messages of the
 * compiler say. */
#ifndef FRAY_TOOLS_SCENE_LANGUAGE_SOURCE_H
#define FRAY_TOOLS_SCENE_LANGUAGE_SOURCE_H

#include <stdint.h>

#include "tools/scene_language/exact.h"
#include "tools/scene_language/units.h"

enum { SOURCE_KEYS = 640, SOURCE_BLOCKS = 32, SOURCE_SAID = 56, SOURCE_VALUE = 48 };

/* In the text, from 1; line 0: nowhere. */
typedef struct {
  int line, column;
} scene_place;

typedef struct {
  const char *key;
  uint32_t block;        /* its number among those of scene.h */
  scene_place place;
  char
      said[SOURCE_SAID]; /* with its values: "mass 1 mg"; a long one ends in dots, a block before its brace */
  const char *unit;      /* the last one in it, "" without; NULL: none was read */
  exact factor;          /* of that unit */
  unit_quantity quantity;
} source_key;

typedef struct {
  scene_place block[SOURCE_BLOCKS]; /* the word that opens it */
  source_key keys[SOURCE_KEYS];     /* in the order of the text; later ones are left out */
  uint32_t count;
} scene_source;

/* The first use of the key in that block; NULL: it has its default. */
const source_key *source_find(const scene_source *s, uint32_t block, const char *key);
/* Of the key, else of its block, else of block 0, the scene. */
scene_place source_place(const scene_source *s, uint32_t block, const char *key);
/* "'mass 1 mg'", or "the default of 'mass'"; returns text. */
const char *source_found(const scene_source *s, uint32_t block, const char *key, char text[SOURCE_SAID + 24]);
/* A value in the units of scene.h, as text in the unit of the key ("0.35 g"); without one, in that of
 * ranges of `quantity`. Rounded to 6 digits: way < 0 down, > 0 up, 0 to the nearest. Returns text. */
const char *source_value(const scene_source *s, uint32_t block, const char *key, unit_quantity quantity,
                         exact value, int way, char text[SOURCE_VALUE]);

#endif
