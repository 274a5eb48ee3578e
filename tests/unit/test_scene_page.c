/* SPDX-License-Identifier: Apache-2.0 */
/* The tables of tools/scene_language/README.md against the parser's: every key has a row in the table of its
 * block and every row is a key; what a row shows is taken there; its range and its default are the parser's.
 * Run from the repository's root. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rt/state/rigid_body.h"
#include "tests/lib/test.h"
#include "tools/scene_language/number.h"
#include "tools/scene_language/parser.h"

static const char PAGE[] = "tools/scene_language/README.md";
enum { ROWS = 128, CELLS = 5, CELL = 1024 };

typedef struct {
  char table[32]; /* behind "key of" */
  char cell[CELLS][CELL];
  int line;
} page_row;

static page_row rows[ROWS];
static int row_count;

/* "| a | b |" */
static int split_cells(const char *line, char cell[CELLS][CELL]) {
  int count = 0;
  if (line[0] != '|') return 0;
  for (const char *from = line + 1; count < CELLS; ++count) {
    const char *to = strchr(from, '|');
    if (to == NULL) break;
    while (*from == ' ') ++from;
    size_t bytes = to > from ? (size_t)(to - from) : 0;
    while (bytes > 0 && from[bytes - 1] == ' ') --bytes;
    snprintf(cell[count], CELL, "%.*s", (int)bytes, from);
    from = to + 1;
  }
  return count;
}

static void read_page(void) {
  static char line[4 * CELL];
  static char cells[CELLS][CELL];
  char table[32] = "";
  int number = 0;
  FILE *in = fopen(PAGE, "rb");
  CHECK(in != NULL);
  while (in != NULL && fgets(line, sizeof line, in) != NULL) {
    ++number;
    if (split_cells(line, cells) == 0) table[0] = 0;
    if (strncmp(cells[0], "key of ", 7) == 0 && line[0] == '|') {
      snprintf(table, sizeof table, "%.31s", cells[0] + 7);
    } else if (line[0] == '|' && table[0] != 0 && cells[0][0] == '`' && row_count < ROWS) {
      page_row *r = &rows[row_count++];
      memcpy(r->cell, cells, sizeof cells);
      memcpy(r->table, table, sizeof table);
      r->line = number;
    }
  }
  if (in != NULL) fclose(in);
}

/* Tells where in the page it is. */
static void check_row(const page_row *r, const char *key, int good, const char *what) {
  CHECK(good);
  if (!good) printf("  %s:%d, key '%s': %s\n", PAGE, r != NULL ? r->line : 0, key, what);
}

static int is_of(const page_row *r, const char *block) {
  char quoted[40];
  snprintf(quoted, sizeof quoted, "`%s`", block);
  if (strcmp(r->table, quoted) == 0) return 1;
  if (strcmp(r->table, "both cloths") == 0)
    return strcmp(block, "woven") == 0 || strcmp(block, "membrane") == 0;
  if (strcmp(r->table, "the scene") == 0) return strcmp(block, "scene") == 0;
  return strcmp(r->table, "a body") == 0 && strcmp(block, "body") == 0;
}

/* The n-th text in back quotes of the first cell. Returns 0 iff there is none. */
static int shown(const page_row *r, int n, char text[CELL]) {
  const char *at = r->cell[0];
  for (;; --n) {
    const char *open = strchr(at, '`');
    const char *close = open != NULL ? strchr(open + 1, '`') : NULL;
    if (close == NULL) return 0;
    if (n == 0) {
      snprintf(text, CELL, "%.*s", (int)(close - open - 1), open + 1);
      return 1;
    }
    at = close + 1;
  }
}

static int begins_with_key(const char *text, const char *key) {
  const size_t length = strlen(key);
  return strncmp(text, key, length) == 0 && (text[length] == 0 || text[length] == ' ');
}

/* The row of a key, and what it shows of it. */
static const page_row *find_row(const char *block, const char *key, char text[CELL]) {
  for (int n = 0; n < row_count; ++n)
    for (int k = 0; is_of(&rows[n], block) && shown(&rows[n], k, text); ++k)
      if (begins_with_key(text, key)) return &rows[n];
  return NULL;
}

/* "0.1 to 3 cm", "1 mm to 1 m", "+-60 m": the unit of the range where there is none. */
static int read_bounds(const char *cell, unit_quantity quantity, exact bounds[2]) {
  exact factor[2];
  char unit[2][16] = {"", ""};
  const int both = strncmp(cell, "+-", 2) == 0;
  size_t used;
  if (both) cell += 2;
  for (int n = both; n < 2; ++n) {
    if (number_read(cell, strlen(cell), &bounds[n], &used) != NUMBER_GOOD) return 0;
    cell += used;
    if (*cell == ' ') ++cell;
    const size_t length = strncmp(cell, "to ", 3) == 0 ? 0 : strcspn(cell, " ");
    snprintf(unit[n], sizeof unit[n], "%.*s", (int)length, cell);
    cell += length;
    if (n == 0)
      cell = strncmp(cell, " to ", 4) == 0 ? cell + 4 : strncmp(cell, "to ", 3) == 0 ? cell + 3 : cell;
  }
  if (*cell != 0) return 0;
  if (unit[0][0] == 0) memcpy(unit[0], unit[1], sizeof unit[0]);
  for (int n = 0; n < 2; ++n) {
    (void)units_of_range(quantity, &factor[n]);
    if (unit[n][0] != 0 && units_find(quantity, unit[n], strlen(unit[n]), &factor[n]) == NULL) return 0;
  }
  bounds[1] = exact_mul(bounds[1], factor[1]);
  bounds[0] = both ? exact_sub(exact_make(0, 1), bounds[1]) : exact_mul(bounds[0], factor[0]);
  return 1;
}

static int range_is(const char *cell, const value_range *range) {
  exact bounds[2];
  exact min;
  exact max;
  exact factor;
  size_t used;
  if (range->min == range->max || strcmp(range->min, range->max) == 0) return 1; /* the reader knows */
  number_read(range->min, strlen(range->min), &min, &used);
  number_read(range->max, strlen(range->max), &max, &used);
  (void)units_of_range(range->quantity, &factor);
  return read_bounds(cell, range->quantity, bounds) &&
         exact_compare(bounds[0], exact_mul(min, factor)) == 0 &&
         exact_compare(bounds[1], exact_mul(max, factor)) == 0;
}

/* ---- scenes with one key ---- */

static const char *const needs[][2] = {
    {"scene", "scene s"},          {"warps", "warps 8"},           {"wefts", "wefts 8"},
    {"spacing", "spacing 12 /cm"}, {"columns", "columns 4"},       {"rows", "rows 4"},
    {"cell", "cell 1 cm"},         {"material", "material denim"}, {"radius", "radius 1 cm"},
    {"size", "size 1 1 1 cm"},     {"length", "length 1 cm"},      {"obj", "obj x.obj"}};

static void append(char *to, const char *text) {
  const size_t length = strlen(to);
  snprintf(to + length, 2 * CELL - length, " %s\n", text);
}

/* All keys that the block needs, and this one. */
static void fill_block(const block_rule *rule, const char *key, const char *text, char to[2 * CELL]) {
  int is_needed = 0;
  to[0] = 0;
  for (int k = 0; k < rule->count; ++k) {
    if ((rule->keys[k].flags & KEY_NEEDED) == 0) continue;
    const int own = strcmp(rule->keys[k].name, key) == 0;
    is_needed |= own;
    for (size_t n = 0; n < sizeof needs / sizeof needs[0]; ++n)
      if (strcmp(needs[n][0], rule->keys[k].name) == 0) append(to, own ? text : needs[n][1]);
  }
  if (!is_needed) append(to, text);
}

static int is_one_of(const char *key, const char *const *list) {
  while (*list != NULL && strcmp(*list, key) != 0) ++list;
  return *list != NULL;
}

static scene parsed;

/* The text of a key in its block. */
static int parses(const block_rule *rule, const char *shape, const char *key, const char *text) {
  static const char *const of_membranes[] = {"wind", "load", "spare_triangles", NULL};
  static const char *const of_free[] = {"mass", "velocity", NULL};
  static const char *const of_sheets[] = {"poisson", "thickness", "breaks", "average", "cracks", NULL};
  static const char *const of_handles[] = {"coupling", "coupling_damping", "hand_scale", "hand_rotate",
                                           "hand_offset", "force_scale", NULL};
  static const char *const is_material[] = {"density", "base", NULL};
  static char inside[2 * CELL];
  static char all[4 * CELL];
  scene_error error;
  const char *cloth = "woven { warps 8 wefts 8 spacing 12 /cm }";
  if (is_one_of(key, of_membranes)) cloth = "membrane { columns 4 rows 4 cell 1 cm material denim }";
  fill_block(rule, key, text, inside);
  if (strcmp(rule->name, "scene") == 0)
    snprintf(all, sizeof all, "%s%s\n", inside, cloth);
  else if (strcmp(rule->name, "woven") == 0 || strcmp(rule->name, "membrane") == 0)
    snprintf(all, sizeof all, "scene s\n%s {\n%s}\n", rule->name, inside);
  else if (strcmp(rule->name, "material") == 0)
    snprintf(all, sizeof all,
             "scene s\nmembrane { columns 4 rows 4 cell 1 cm material m }\nmaterial m {\n%s%s%s}\n", inside,
             is_one_of(key, is_material) ? "" : " density 200 g/m2\n",
             strcmp(key, "isotropic") == 0 || strcmp(key, "base") == 0 || strcmp(key, "stretch") == 0 ||
                     strcmp(key, "young") == 0
                 ? ""
             : is_one_of(key, of_sheets) ? " young 1 GPa\n"
                 : " isotropic 1000 N/m 0.3\n");
  else if (strcmp(rule->name, "body") == 0)
    snprintf(all, sizeof all, "scene s\n%s\n%s b {\n%s%s%s%s}\n", cloth, shape, inside,
             strcmp(key, "at") == 0 ? "" : " at 0 0 9 cm\n", is_one_of(key, of_free) ? " move free\n" : "",
             is_one_of(key, of_handles)     ? " move hand left\n mass 5 g\n"
             : strcmp(key, "velocity") == 0 ? " mass 1 g\n" : "");
  else
    snprintf(all, sizeof all, "scene s\n%s\n%s {\n%s}\n", cloth, rule->name, inside);
  const int good = scene_parse("page", all, strlen(all), &parsed, &error);
  if (!good) printf("%s%d:%d: %s\n", all, error.line, error.column, error.message);
  return good;
}

static const void *target_of(const block_rule *rule) {
  if (strcmp(rule->name, "body") == 0) return &parsed.bodies[0];
  return strcmp(rule->name, "material") == 0 ? (const void *)&parsed.materials[0] : &parsed;
}

/* What the default says is what the block has without the key. */
static void check_default(const page_row *r, const block_rule *rule, const char *shape, const block_key *key,
                          const char *cell) {
  char text[CELL + 64];
  unsigned char field[sizeof(exact) * VALUES_MAX];
  size_t bytes = key->read == block_exacts ? sizeof(exact) * (size_t)key->count : sizeof(uint32_t);
  const int has_field =
      key->read == block_exacts || key->read == block_count || key->read == block_auto_count;
  const int says_value = strspn(cell, "-0123456789.") > 0 || strcmp(cell, "auto") == 0;
  if (!has_field || !says_value || strstr(cell, " a ") != NULL || strstr(cell, "`tear`") != NULL) return;
  snprintf(text, sizeof text, "%s %s", key->name, cell);
  check_row(r, key->name, parses(rule, shape, key->name, text), "the default is taken");
  memcpy(field, (const char *)target_of(rule) + key->offset, bytes);
  check_row(r, key->name, parses(rule, shape, "", ""), "a block without it");
  check_row(r, key->name, memcmp(field, (const char *)target_of(rule) + key->offset, bytes) == 0,
            "the default is what the page says");
}

static void check_key(const block_rule *rule, const char *shape, const block_key *key) {
  char text[CELL];
  const page_row *r = find_row(rule->name, key->name, text);
  check_row(r, key->name, r != NULL, "has a row");
  if (r == NULL) return;
  const int of_body = shape != NULL;
  const char *by_default = r->cell[1 + of_body];
  if (of_body)
    check_row(r, key->name, strcmp(r->cell[1], "all") == 0 || strstr(r->cell[1], shape) != NULL,
              "names this body");
  check_row(r, key->name, range_is(r->cell[2 + of_body], &key->range), "the range is the parser's");
  if ((key->flags & KEY_NEEDED) != 0)
    check_row(r, key->name, strcmp(by_default, "**needed**") == 0, "is needed");
  else
    check_default(r, rule, shape, key, by_default);
  for (int k = 0; strstr(text, "...") == NULL && shown(r, k, text); ++k)
    if (begins_with_key(text, key->name))
      check_row(r, key->name, parses(rule, shape, key->name, text), "is taken as the page shows it");
}

static const block_rule *const rules[] = {&scene_rule,    &woven_rule,  &membrane_rule,
                                          &material_rule, &limits_rule, &hands_rule};
static const char *const shapes[] = {
#define X(name, word, radius, halves, primitive, collider) word,
    SHAPES(X)
#undef X
};

static void every_key_is_as_the_page_says(void) {
  block_key keys[BLOCK_KEYS];
  for (size_t n = 0; n < sizeof rules / sizeof rules[0]; ++n)
    for (int k = 0; k < rules[n]->count; ++k) check_key(rules[n], NULL, &rules[n]->keys[k]);
  for (size_t n = 0; n < sizeof shapes / sizeof shapes[0]; ++n) {
    const block_rule rule = body_rule_of((fray_shape)((int)n + FRAY_ANCHOR + 1), keys);
    for (int k = 0; k < rule.count; ++k) check_key(&rule, shapes[n], &keys[k]);
  }
}

static int has_key(const block_rule *rule, const char *text) {
  for (int k = 0; k < rule->count; ++k)
    if (begins_with_key(text, rule->keys[k].name)) return 1;
  return 0;
}

static void every_row_is_a_key(void) {
  char text[CELL];
  block_key keys[BLOCK_KEYS];
  for (int n = 0; n < row_count; ++n)
    for (int k = 0; shown(&rows[n], k, text); ++k) {
      int found = 0;
      for (size_t b = 0; b < sizeof rules / sizeof rules[0]; ++b)
        found |= is_of(&rows[n], rules[b]->name) && has_key(rules[b], text);
      for (size_t b = 0; b < sizeof shapes / sizeof shapes[0]; ++b) {
        const block_rule rule = body_rule_of((fray_shape)((int)b + FRAY_ANCHOR + 1), keys);
        found |= is_of(&rows[n], "body") && has_key(&rule, text);
      }
      check_row(&rows[n], text, found, "is a key of the parser");
    }
  printf("  %d rows\n", row_count);
  CHECK(row_count > 80);
}

int main(void) {
  read_page();
  TEST(every_key_is_as_the_page_says);
  TEST(every_row_is_a_key);
  return test_end();
}
