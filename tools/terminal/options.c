/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/terminal/options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/terminal/file_place.h"

static int take_number(const char *command, const option *o, const char *word) {
  char *end;
  const unsigned long v = strtoul(word, &end, 10);
  if (word[0] < '0' || word[0] > '9' || *end != 0 || v < o->min || v > o->max) {
    fprintf(stderr, "fray %s: %s '%s', expected a number from %u to %u\n", command, o->name, word,
            o->min, o->max);
    return 0;
  }
  *o->number = (uint32_t)v;
  return 1;
}

static int check_output(const char *command, const char *name, const char *word) {
  const int is_dash = strcmp(word, "-") == 0;
  if (!is_dash && !file_place_is_standard_output(word)) return 1;
  fprintf(stderr, "fray %s: %s %s, expected a name%s: standard output has what is printed\n", command, name, word,
          is_dash ? " (./- for a file called so)" : " of another file");
  return 0;
}

static int take_option(int argc, char **argv, int *n, const option *o) {
  if (o->flag != NULL) {
    *o->flag = 1;
    return 1;
  }
  if (*n + 1 == argc || argv[*n + 1][0] == 0) {
    fprintf(stderr, "fray %s: %s, expected a value after it\n", argv[0], o->name);
    return 0;
  }
  const char *word = argv[++*n];
  if (o->number != NULL) return take_number(argv[0], o, word);
  *o->text = word;
  return (o->min != OPTION_OUTPUT && o->min != OPTION_FOLDER) || check_output(argv[0], o->name, word);
}

static void complain(const char *command, const char *word, const option *table, uint32_t count) {
  fprintf(stderr, "fray %s: unexpected '%s'; options:", command, word);
  for (uint32_t k = 0; k < count; ++k) fprintf(stderr, " %s", table[k].name);
  fprintf(stderr, " --help\n");
}

static int refuse_output(const char *command, const option *output, const char *what, const char *file) {
  fprintf(stderr, "fray %s: %s %s %s the file of %s %s, expected another one\n", command, output->name, *output->text,
          output->min == OPTION_FOLDER ? "goes over" : "is", what, file);
  return 0;
}

static int is_given(const option *o, option_word kind) {
  return o->text != NULL && *o->text != NULL && o->min == (uint32_t)kind;
}

/* Whether `output` goes over `file`; a folder does over what has a name of its pictures or its summary. */
static int goes_over(const option *output, const char *file) {
  if (file_place_is_one(file, *output->text)) return 1;
  if (!is_given(output, OPTION_FOLDER) || !file_place_is_in(file, *output->text)) return 0;
  const char *name = file_place_name(file), *dot = strrchr(name, '.');
  return strcmp(name, "summary.txt") == 0 || (dot != NULL && strcmp(dot, ".png") == 0);
}

int options_are_apart(const char *command, const option *table, uint32_t count, const char *operand) {
  for (uint32_t k = 0; k < count; ++k) {
    const option *output = &table[k];
    const int is_folder = is_given(output, OPTION_FOLDER);
    if (!is_folder && !is_given(output, OPTION_OUTPUT)) continue;
    if (operand != NULL && goes_over(output, operand)) return refuse_output(command, output, "the input", operand);
    for (uint32_t n = 0; n < count; ++n) {
      const int clashes = is_given(&table[n], OPTION_INPUT) || ((n < k || is_folder) && is_given(&table[n], OPTION_OUTPUT));
      if (clashes && goes_over(output, *table[n].text))
        return refuse_output(command, output, table[n].name, *table[n].text);
    }
  }
  return 1;
}

/* A value that is given again would be lost without a word. */
static int is_first(const char *command, const option *o, uint32_t k, uint64_t *given) {
  const int is_new = (*given >> k & 1u) == 0;
  *given |= (uint64_t)1 << k;
  if (is_new || o->flag != NULL) return 1;
  fprintf(stderr, "fray %s: %s a second time, expected it once\n", command, o->name);
  return 0;
}

options_result options_parse(int argc, char **argv, const option *table, uint32_t count,
                             const char **operand) {
  uint64_t given = 0;
  for (int n = 1; n < argc; ++n) {
    if (strcmp(argv[n], "--help") == 0 || strcmp(argv[n], "-h") == 0) return OPTIONS_HELP;
    uint32_t k = 0;
    while (k < count && strcmp(argv[n], table[k].name) != 0) ++k;
    if (k < count) {
      if (!is_first(argv[0], &table[k], k, &given) || !take_option(argc, argv, &n, &table[k])) return OPTIONS_WRONG;
    } else if (argv[n][0] != '-' && *operand == NULL) {
      *operand = argv[n];
    } else {
      complain(argv[0], argv[n], table, count);
      return OPTIONS_WRONG;
    }
  }
  return options_are_apart(argv[0], table, count, *operand) ? OPTIONS_GOOD : OPTIONS_WRONG;
}
