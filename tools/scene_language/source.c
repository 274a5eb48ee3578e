/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/scene_language/source.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "tools/scene_language/number.h"

const source_key *source_find(const scene_source *s, uint32_t block, const char *key) {
  for (uint32_t n = 0; n < s->count; n++)
    if (s->keys[n].block == block && strcmp(s->keys[n].key, key) == 0) return &s->keys[n];
  return NULL;
}

scene_place source_place(const scene_source *s, uint32_t block, const char *key) {
  const source_key *k = source_find(s, block, key);
  return k != NULL ? k->place : s->block[block].line != 0 ? s->block[block] : s->block[0];
}

const char *source_found(const scene_source *s, uint32_t block, const char *key,
                         char text[SOURCE_SAID + 24]) {
  const source_key *k = source_find(s, block, key);
  if (k != NULL)
    snprintf(text, SOURCE_SAID + 24, "'%s'", k->said);
  else
    snprintf(text, SOURCE_SAID + 24, "the default of '%s'", key);
  return text;
}

const char *source_value(const scene_source *s, uint32_t block, const char *key, unit_quantity quantity,
                         exact value, int way, char text[SOURCE_VALUE]) {
  const source_key *k = source_find(s, block, key);
  char number[NUMBER_TEXT];
  exact factor;
  const char *unit = units_of_range(quantity, &factor);
  if (k != NULL && k->unit != NULL && k->quantity == quantity) {
    unit = k->unit;
    factor = k->factor;
  }
  snprintf(text, SOURCE_VALUE, "%s%s%s", number_write(exact_div(value, factor), way, number),
           unit[0] != 0 ? " " : "", unit);
  return text;
}
