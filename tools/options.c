/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/options.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int take_number(const char *verb, const option *o, const char *word) {
  char *end;
  const unsigned long v = strtoul(word, &end, 10);
  if (word[0] < '0' || word[0] > '9' || *end != 0 || v < o->least || v > o->most) {
    fprintf(stderr, "fray %s: %s '%s', expected a number from %u to %u\n", verb, o->name, word,
            o->least, o->most);
    return 0;
  }
  *o->number = (uint32_t)v;
  return 1;
}

static int take_option(int argc, char **argv, int *n, const option *o) {
  if (o->flag != NULL) {
    *o->flag = 1;
    return 1;
  }
  if (*n + 1 == argc || argv[*n + 1][0] == 0) {
    fprintf(stderr, "fray %s: %s, expected a value behind it\n", argv[0], o->name);
    return 0;
  }
  const char *word = argv[++*n];
  if (o->number != NULL) return take_number(argv[0], o, word);
  *o->text = word;
  return 1;
}

static void complain(const char *verb, const char *word, const option *table, uint32_t count) {
  fprintf(stderr, "fray %s: unexpected '%s'; options:", verb, word);
  for (uint32_t k = 0; k < count; ++k) fprintf(stderr, " %s", table[k].name);
  fprintf(stderr, " --help\n");
}

options_result options_parse(int argc, char **argv, const option *table, uint32_t count,
                             const char **operand) {
  for (int n = 1; n < argc; ++n) {
    if (strcmp(argv[n], "--help") == 0 || strcmp(argv[n], "-h") == 0) return OPTIONS_HELP;
    uint32_t k = 0;
    while (k < count && strcmp(argv[n], table[k].name) != 0) ++k;
    if (k < count) {
      if (!take_option(argc, argv, &n, &table[k])) return OPTIONS_WRONG;
    } else if (argv[n][0] != '-' && *operand == NULL) {
      *operand = argv[n];
    } else {
      complain(argv[0], argv[n], table, count);
      return OPTIONS_WRONG;
    }
  }
  return OPTIONS_GOOD;
}
