/* SPDX-License-Identifier: Apache-2.0 */
/* Command lines: a table of options, one operand, messages that say what was expected. */
#ifndef FRAY_TOOLS_OPTIONS_H
#define FRAY_TOOLS_OPTIONS_H

#include <stdint.h>

typedef struct {
  const char *name;   /* "--ticks" */
  const char **text;  /* takes a word */
  uint32_t *number;   /* or a whole number */
  int *flag;          /* or nothing: set to 1 */
  uint32_t least, most; /* of a number */
} option;

typedef enum { OPTIONS_GOOD, OPTIONS_HELP, OPTIONS_WRONG } options_result;

/* argv[0] is the verb. At most one word that is no option goes to *operand. On OPTIONS_WRONG a
 * message is on stderr; on OPTIONS_HELP the caller prints its usage. */
options_result options_parse(int argc, char **argv, const option *table, uint32_t count,
                             const char **operand);

#endif
