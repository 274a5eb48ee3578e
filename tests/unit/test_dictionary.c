/* SPDX-License-Identifier: Apache-2.0 */
/* The message table itself, and the texts that are written from it: rt/wire/fray.dbc and what is
 * between marks in rt/wire/README.md. `test_dictionary --write` writes them anew.
 * Run from the repository's root. */
#define _POSIX_C_SOURCE 200809L
#include "tests/lib/dictionary_text.h"

#include <stdlib.h>

#include "rt/wire/frame.h"
#include "rt/wire/signals.h"
#include "tests/lib/test.h"

static const char DBC[] = "rt/wire/fray.dbc";
static const char README[] = "rt/wire/README.md";
static const char END[] = "<!-- end -->\n";

/* The blocks of README that are written, each from its mark to END. */
static const struct {
  const char *mark;
  void (*writer)(FILE *);
} BLOCKS[] = {{"<!-- begin: written by build/tests/unit/test_dictionary --write -->\n", dictionary_write_markdown},
              {"<!-- begin faults: written by build/tests/unit/test_dictionary --write -->\n", dictionary_write_faults}};
enum { BLOCK_COUNT = sizeof BLOCKS / sizeof *BLOCKS };

static char *read_all(const char *file) {
  FILE *in = fopen(file, "rb");
  char *text = calloc(1, 1 << 16);
  if (in == NULL || text == NULL) {
    perror(file);
    exit(1);
  }
  text[fread(text, 1, (1 << 16) - 1, in)] = 0;
  fclose(in);
  return text;
}

static char *written_by(void (*writer)(FILE *)) {
  char *text = NULL;
  size_t bytes = 0;
  FILE *out = open_memstream(&text, &bytes);
  if (out == NULL) exit(1);
  writer(out);
  fclose(out);
  return text;
}

/* Names the first line that differs. */
static void check_lines(const char *file, const char *is, const char *expected) {
  int line = 1;
  size_t n = 0, start = 0;
  for (; is[n] == expected[n] && is[n] != 0; ++n) {
    if (is[n] != '\n') continue;
    line += 1;
    start = n + 1;
  }
  if (is[n] == expected[n]) return;
  printf("%s, line %d of what is written:\n  is       %.*s\n  expected %.*s\n", file, line,
         (int)strcspn(is + start, "\n"), is + start, (int)strcspn(expected + start, "\n"),
         expected + start);
  CHECK(0);
}

static void dbc_is_the_table(void) {
  char *is = read_all(DBC), *expected = written_by(dictionary_write_dbc);
  check_lines(DBC, is, expected);
  free(is);
  free(expected);
}

/* The text of a block: *end is where its END begins. NULL iff a mark is missing. */
static char *block_begin(char *readme, int n, char **end) {
  char *mark = strstr(readme, BLOCKS[n].mark);
  if (mark == NULL) return NULL;
  *end = strstr(mark, END);
  return *end == NULL ? NULL : mark + strlen(BLOCKS[n].mark);
}

static void readme_is_the_tables(void) {
  for (int n = 0; n < BLOCK_COUNT; ++n) {
    char *is = read_all(README), *expected = written_by(BLOCKS[n].writer), *end = NULL;
    char *begin = block_begin(is, n, &end);
    CHECK(begin != NULL);
    if (begin != NULL) {
      *end = 0;
      check_lines(README, begin, expected);
    }
    free(is);
    free(expected);
  }
}

static void ids_are_distinct_and_frozen(void) {
  static unsigned char seen[FRAME_ID_MAX + 1];
  static const uint16_t OF_INSTANCE_7[MESSAGES] = {0x087, 0x01E, 0x01F, 0x171, 0x172, 0x1F1,
                                                   0x1F2, 0x207, 0x708, 0x02E, 0x02F, 0x179,
                                                   0x17A, 0x1F9, 0x1FA, 0x371, 0x372, 0x710};
  for (int m = 0; m < (int)MESSAGES; ++m) {
    CHECK_EQ_INT(dictionary_id((dictionary_message)m, 7), OF_INSTANCE_7[m]);
    for (uint32_t n = 0; n < DICTIONARY_INSTANCES; ++n) {
      const uint32_t id = dictionary_id((dictionary_message)m, n);
      CHECK(id <= FRAME_ID_MAX && !seen[id & FRAME_ID_MAX]);
      seen[id & FRAME_ID_MAX] = 1;
    }
  }
}

static void check_bits(const signals_signal *list, uint32_t bits, unsigned char used[160]) {
  for (const signals_signal *s = list; s->name != NULL; ++s) {
    CHECK(s->bits > 0 && s->start + s->bits <= bits);
    for (unsigned n = s->start; n < s->start + s->bits && n < 160; ++n) {
      CHECK_EQ_INT(used[n], 0);
      used[n] = 1;
    }
    const int64_t least = s->is_signed ? -(INT64_C(1) << (s->bits - 1)) : 0;
    CHECK(s->min >= least && s->max > 0 && s->min <= s->max);
    CHECK(s->max <= least + (INT64_C(1) << s->bits) - 1);
    for (const signals_value *v = s->values; v != NULL && v->name != NULL; ++v) {
      CHECK(v->value >= s->min && v->value <= s->max);
    }
  }
}

static void signals_fit_and_do_not_overlap(void) {
  for (int n = 0; n < (int)MESSAGES; ++n) {
    const dictionary_message m = (dictionary_message)n;
    const int auth = DICTIONARY[m].protects != MESSAGES;
    unsigned char used[160] = {0};
    CHECK_EQ_INT(dictionary_length(m), auth ? 20 : 8);
    check_bits(SIGNALS[m].signals, 64, used);
    if (!auth) continue;
    check_bits(SIGNALS_TRAILER, 160, used);
    for (int bit = 64; bit < 160; ++bit) CHECK_EQ_INT(used[bit], 1);
  }
}

static void a_protected_form_is_its_plain_one(void) {
  int forms = 0;
  for (int n = 0; n < (int)MESSAGES; ++n) {
    const dictionary_message m = (dictionary_message)n;
    const dictionary_message form = dictionary_auth(m);
    if (form == MESSAGES) continue;
    forms += 1;
    CHECK_EQ_INT(DICTIONARY[form].protects, m);
    CHECK_EQ_INT(DICTIONARY[form].cycle_ms, DICTIONARY[m].cycle_ms);
    CHECK(SIGNALS[form].signals == SIGNALS[m].signals);
    CHECK_TEXT(SIGNALS[form].from, SIGNALS[m].from);
    CHECK_TEXT(SIGNALS[form].to, SIGNALS[m].to);
    char name[32];
    snprintf(name, sizeof name, "%s_AUTH", SIGNALS[m].name);
    CHECK_TEXT(SIGNALS[form].name, name);
  }
  CHECK_EQ_INT(forms, 6);
  CHECK_EQ_INT(dictionary_auth(MESSAGE_SYNC), MESSAGES);
  CHECK_EQ_INT(dictionary_auth(MESSAGES), MESSAGES);
}

static void write_file(const char *file, const char *head, size_t bytes, const char *body,
                       const char *tail) {
  FILE *out = fopen(file, "wb");
  if (out == NULL) {
    perror(file);
    exit(1);
  }
  fprintf(out, "%.*s%s%s", (int)bytes, head, body, tail);
  if (fclose(out) != 0) exit(1);
}

static int write_all(void) {
  for (int n = 0; n < BLOCK_COUNT; ++n) {
    char *readme = read_all(README), *text = written_by(BLOCKS[n].writer), *end = NULL;
    char *begin = block_begin(readme, n, &end);
    if (begin == NULL) {
      fprintf(stderr, "%s: no marks to write between\n", README);
      return 1;
    }
    write_file(README, readme, (size_t)(begin - readme), text, end);
    free(text);
    free(readme);
  }
  char *dbc = written_by(dictionary_write_dbc);
  write_file(DBC, "", 0, dbc, "");
  free(dbc);
  return 0;
}

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "--write") == 0) return write_all();
  TEST(dbc_is_the_table);
  TEST(readme_is_the_tables);
  TEST(ids_are_distinct_and_frozen);
  TEST(signals_fit_and_do_not_overlap);
  TEST(a_protected_form_is_its_plain_one);
  return test_end();
}
