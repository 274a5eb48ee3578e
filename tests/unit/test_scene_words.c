/* SPDX-License-Identifier: Apache-2.0 */
/* Every word of scenes before version 0.4 is refused where it was used, with the word of today; the
 * word of today is taken there. */
#include <stdio.h>

#include "tests/lib/test.h"
#include "tools/scene_language/parser.h"

#define WOVEN_KEYS " warps 8 wefts 6 spacing 12 /cm "
#define WOVEN "scene s woven {" WOVEN_KEYS
#define MEMBRANE "scene s membrane { columns 4 rows 3 material denim "
#define CELL "cell 1 cm "
#define MATERIAL MEMBRANE CELL "} material m { "
#define CAPSULE WOVEN "} capsule c { length 1 cm radius 1 cm at 0 0 0 cm "

/* scene = before + word + after */
typedef struct {
  const char *old, *now, *before, *after;
} word_case;

static const word_case cases[] = {
    {"sheet", "woven", "scene s ", " {" WOVEN_KEYS "}"},
    {"triangles", "membrane", "scene s ", " { columns 4 rows 3 cell 1 cm material denim }"},
    {"sweeps", "iterations", WOVEN "} ", " 2"},
    {"rest_strain", "max_rest_strain", WOVEN "} ", " 2 %"},
    {"ball", "sphere", WOVEN "} ", " b { radius 1 cm at 0 0 0 cm }"},
    {"bar", "capsule", WOVEN "} ", " b { length 1 cm radius 1 cm at 0 0 0 cm }"},
    {"plane", "orientation", WOVEN, " vertical }"},
    {"transition", "split_strain", WOVEN, " 4 8 % }"},
    {"loose", "disconnect_at", WOVEN, " 0.3 mm }"},
    {"loose_by", "disconnect_by", WOVEN, " particles }"},
    {"slip_grip", "crossing_friction", WOVEN, " 0.3 mN }"},
    {"edge", "cell", MEMBRANE, " 1 2 cm }"},
    {"mesh", "pattern", MEMBRANE CELL, " irregular 3 }"},
    {"plane", "orientation", MEMBRANE CELL, " horizontal }"},
    {"inner_steps", "elastic_steps_max", MEMBRANE CELL, " 32 }"},
    {"collide", "collision", MEMBRANE CELL, " vertices }"},
    {"turned", "rotated", MEMBRANE CELL "pattern ", " 30 deg }"},
    {"whole", "triangles", MEMBRANE CELL "collision ", " }"},
    {"like", "base", MATERIAL, " denim }"},
    {"relax", "tear_interval", MATERIAL "base paper tear 2 N/m ", " 2 ms }"},
    {"cut", "cut_speed", MATERIAL "base paper ", " 0.5 m/s }"},
    {"grip", "attach_within", CAPSULE, " 0.02 cm }"},
    {"turn", "rotate", CAPSULE, " 30 deg about z }"},
    {"cuts_per_tick", "tears_per_tick", WOVEN "} limits { ", " 3 }"},
    {"self_pairs", "self_collision_pairs", WOVEN "} limits { ", " 3 }"},
    {"ramp", "ramp_up", WOVEN "} hands { ", " 100 ms }"},
    {"fade", "ramp_down", WOVEN "} hands { ", " 10 ms }"},
};
enum { CASES = sizeof cases / sizeof cases[0] };

static scene parsed;
static scene_error failure;

static int parse(const word_case *c, const char *word) {
  char text[400];
  snprintf(text, sizeof text, "\n%s%s%s\n", c->before, word, c->after);
  const int good = scene_parse("x.scene", text, strlen(text), &parsed, &failure);
  if (!good && word == c->now) printf("%s\n%d:%d: %s\n", text, failure.line, failure.column, failure.message);
  return good;
}

static void old_words_name_the_new(void) {
  for (size_t k = 0; k < CASES; k++) {
    char wanted[80];
    snprintf(wanted, sizeof wanted, "'%s' is now '%s'", cases[k].old, cases[k].now);
    CHECK(!parse(&cases[k], cases[k].old));
    CHECK_TEXT(failure.message, wanted);
    CHECK_TEXT(failure.file, "x.scene");
    CHECK_EQ_INT(failure.line, 2);
    CHECK_EQ_INT(failure.column, (int)strlen(cases[k].before) + 1);
  }
}

static void new_words_are_taken(void) {
  for (size_t k = 0; k < CASES; k++) CHECK(parse(&cases[k], cases[k].now));
}

/* A row of the parser's table that has no case above would go untested. */
static void no_row_is_untested(void) {
  CHECK_EQ_INT(old_word_count, CASES);
  for (size_t n = 0; n < old_word_count; n++) {
    size_t found = 0;
    for (size_t k = 0; k < CASES; k++)
      found += strcmp(cases[k].old, old_words[n].old) == 0 && strcmp(cases[k].now, old_words[n].now) == 0;
    CHECK(found > 0);
  }
}

/* `plane` and `mesh` are bodies; an old word outside of its context is as unknown as any other. */
static void words_depend_on_their_context(void) {
  const word_case bodies = {"", "mesh", WOVEN "} plane p { at 0 -5 0 cm } ", " m { obj a.obj at 0 0 0 cm }"};
  const word_case elsewhere = {"relax", "", WOVEN, " 2 ms }"};
  CHECK(parse(&bodies, bodies.now));
  CHECK(!parse(&elsewhere, elsewhere.old));
  CHECK(strncmp(failure.message, "found 'relax', expected a key of the woven cloth", 48) == 0);
}

int main(void) {
  TEST(old_words_name_the_new);
  TEST(new_words_are_taken);
  TEST(no_row_is_untested);
  TEST(words_depend_on_their_context);
  return test_end();
}
