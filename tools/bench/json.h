/* SPDX-License-Identifier: Apache-2.0 */
/* JSON, written in one pass: every value with its key, or NULL in a list. A figure that is no
 * number becomes null. */
#ifndef FRAY_TOOLS_BENCH_JSON_H
#define FRAY_TOOLS_BENCH_JSON_H

#include <stdio.h>

typedef struct {
  FILE *out;
  int depth;
  int first; /* nothing stands yet in what was begun last */
} json;

void json_begin(json *j, const char *key, char bracket); /* '{' or '[' */
void json_end(json *j, char bracket);                    /* '}' or ']' */
void json_text(json *j, const char *key, const char *text);
void json_number(json *j, const char *key, double value); /* four digits behind the point */
void json_count(json *j, const char *key, unsigned long long value);

#endif
