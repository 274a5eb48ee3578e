/* SPDX-License-Identifier: Apache-2.0 */
/* The table of faults, FRAY_FAULTS of rt/fray.h, against all that is made from it: fray.dbc, the page, what
 * `fray run` prints. Every bit has a text, and the scene words that texts name are words of the language.
 * Run from the repository's root. */
#define _POSIX_C_SOURCE 200809L
#include <stdlib.h>

#include "rt/fray.h"
#include "tests/lib/test.h"
#include "tools/analysis/fault_text.h"
#include "tools/scene_language/scene.h"

typedef struct {
  uint32_t value, bit;
  const char *name, *signal, *cause, *action;
} fault;

#define ROW(name, bit, signal, cause, action) {name, bit, #name, signal, cause, action},
static const fault FAULTS[] = {FRAY_FAULTS(ROW)};
enum { COUNT = sizeof FAULTS / sizeof *FAULTS, PREFIX = sizeof "FRAY_FAULT_" - 1, ROOM = 1 << 16 };

static const char *read_all(const char *file) {
  static char text[2][ROOM];
  static int next;
  char *to = text[next++ % 2];
  FILE *in = fopen(file, "rb");
  if (in == NULL) {
    perror(file);
    exit(1);
  }
  to[fread(to, 1, ROOM - 1, in)] = 0;
  fclose(in);
  return to;
}

static const char *printed(uint32_t faults) {
  static char text[ROOM];
  FILE *out = fmemopen(text, sizeof text, "w");
  if (out == NULL) exit(1);
  fault_text_print(out, faults);
  fclose(out);
  return text;
}

static void check_has(const char *text, const char *wanted) {
  if (strstr(text, wanted) == NULL) printf("not there: %s\n", wanted);
  CHECK(strstr(text, wanted) != NULL);
}

/* A sentence for people: some words, a full stop, and nothing that a DBC or a table cannot hold. */
static void check_sentence(const char *text) {
  const size_t length = strlen(text);
  CHECK(length > 20 && length < 200);
  CHECK(length > 0 && text[length - 1] == '.');
  CHECK(strpbrk(text, "\"|\n") == NULL);
}

static void every_bit_has_its_row_and_text(void) {
  CHECK_EQ_INT(COUNT, 14);
  CHECK_EQ_INT(FRAY_FAULTS_ALL, (1 << COUNT) - 1);
  for (uint32_t n = 0; n < COUNT; ++n) {
    const fault *f = &FAULTS[n];
    CHECK_EQ_INT(f->bit, n);
    CHECK_EQ_INT(f->value, 1u << n);
    CHECK(strncmp(f->name, "FRAY_FAULT_", PREFIX) == 0 && f->name[PREFIX] != 0);
    check_sentence(f->cause);
    check_sentence(f->action);
  }
}

/* SELF_COLLISION_BUDGET is SelfCollisionBudget. */
static void a_signal_is_its_name(void) {
  for (uint32_t n = 0; n < COUNT; ++n) {
    char wanted[48];
    size_t length = 0;
    int start = 1;
    for (const char *c = FAULTS[n].name + PREFIX; *c != 0 && length < sizeof wanted - 1; ++c) {
      if (*c != '_') wanted[length++] = (char)(start ? *c : *c - 'A' + 'a');
      start = *c == '_';
    }
    wanted[length] = 0;
    CHECK_TEXT(FAULTS[n].signal, wanted);
  }
}

static void the_dictionary_has_every_bit(void) {
  const char *dbc = read_all("rt/wire/fray.dbc");
  char wanted[600];
  for (uint32_t n = 0; n < COUNT; ++n) {
    const fault *f = &FAULTS[n];
    snprintf(wanted, sizeof wanted, "SG_ STATUS_%s : %u|1@1+ ", f->signal, 16 + (unsigned)n);
    check_has(dbc, wanted);
    snprintf(wanted, sizeof wanted, "VAL_ 1793 STATUS_%s 0 \"OK\" 1 \"%s\" ;", f->signal, f->name + PREFIX);
    check_has(dbc, wanted);
    snprintf(wanted, sizeof wanted, "CM_ SG_ 1793 STATUS_%s \"%s %s\";", f->signal, f->cause, f->action);
    check_has(dbc, wanted);
  }
}

static void the_page_has_every_bit(void) {
  const char *page = read_all("rt/wire/README.md");
  char wanted[600];
  for (uint32_t n = 0; n < COUNT; ++n) {
    const fault *f = &FAULTS[n];
    snprintf(wanted, sizeof wanted, "| %u | `%s` | %s | %s | %s |\n", (unsigned)n, f->name, f->signal, f->cause,
             f->action);
    check_has(page, wanted);
    snprintf(wanted, sizeof wanted, "| STATUS | %s | %u bit %u | 0..1 | 0 OK, 1 %s.", f->signal, 2 + (unsigned)n / 8,
             (unsigned)n % 8, f->name + PREFIX);
    check_has(page, wanted);
  }
}

static void the_command_line_has_every_bit(void) {
  char wanted[600];
  for (uint32_t n = 0; n < COUNT; ++n) {
    const fault *f = &FAULTS[n];
    snprintf(wanted, sizeof wanted, "faults       0x%03X\n  bit %-2u     %s: %s\n               %s\n", 1u << n,
             (unsigned)n, f->name + PREFIX, f->cause, f->action);
    CHECK_TEXT(printed(1u << n), wanted);
    check_has(printed(FRAY_FAULTS_ALL), f->name + PREFIX);
  }
  CHECK_TEXT(printed(0), "faults       none\n");
  CHECK_TEXT(printed(0xC000), "faults       0xC000\n  unknown    0xC000\n");
}

/* A scene of limits alone lacks a cloth, which is an error of another line. */
static void check_limits_word(const char *word, int length) {
  static scene parsed;
  scene_error error = {0};
  char text[80];
  snprintf(text, sizeof text, "scene s\nlimits { %.*s 9 }\n", length, word);
  const int good = scene_parse("x.scene", text, strlen(text), &parsed, &error);
  if (!good && error.line == 2) printf("%s%s\n", text, error.message);
  CHECK(good || error.line != 2);
}

/* What is between backquotes can be written into the limits of a scene. */
static void words_of_the_scene_are_right(void) {
  int words = 0;
  for (uint32_t n = 0; n < COUNT; ++n) {
    for (const char *at = strchr(FAULTS[n].action, '`'); at != NULL; at = strchr(at + 1, '`')) {
      const char *end = strchr(at + 1, '`');
      CHECK(end != NULL);
      if (end == NULL) break;
      check_limits_word(at + 1, (int)(end - at - 1));
      at = end;
      words += 1;
    }
  }
  CHECK_EQ_INT(words, 6);
}

int main(void) {
  TEST(every_bit_has_its_row_and_text);
  TEST(a_signal_is_its_name);
  TEST(the_dictionary_has_every_bit);
  TEST(the_page_has_every_bit);
  TEST(the_command_line_has_every_bit);
  TEST(words_of_the_scene_are_right);
  return test_end();
}
