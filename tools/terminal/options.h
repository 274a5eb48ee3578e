/* SPDX-License-Identifier: Apache-2.0 */
/* Command lines: a table of options, one operand, and messages that name what was expected. */
#ifndef FRAY_TOOLS_TERMINAL_OPTIONS_H
#define FRAY_TOOLS_TERMINAL_OPTIONS_H

#include <stdint.h>

/* What a word names. */
typedef enum {
  OPTION_WORD,
  OPTION_INPUT,
  OPTION_OUTPUT,
  OPTION_FOLDER /* of pictures, *.png, and summary.txt */
} option_word;

typedef struct {
  const char *name;   /* "--ticks" */
  const char **text;  /* takes a word */
  uint32_t *number;   /* or a whole number */
  int *flag;          /* or nothing: set to 1 */
  uint32_t min, max; /* of a number; of a word min is an option_word */
} option;

typedef enum { OPTIONS_GOOD, OPTIONS_HELP, OPTIONS_WRONG } options_result;

/* argv[0] is the command. At most one word that is not an option goes to *operand, which is an input file. Of at
 * most 64 options each that has a value is given once. An output that is one file with an input or another
 * output is refused, and `-` and what standard output is. On OPTIONS_WRONG a message is on stderr; on
 * OPTIONS_HELP the caller prints its usage. */
options_result options_parse(int argc, char **argv, const option *table, uint32_t count,
                             const char **operand);

/* The same for an output that a command names itself. Returns 1, or 0 after a message to stderr. operand: NULL:
 * none. */
int options_are_apart(const char *command, const option *table, uint32_t count, const char *operand);

#endif
