/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/json.h"

#include <math.h>

static void put_text(json *j, const char *text) {
  fputc('"', j->out);
  for (const unsigned char *c = (const unsigned char *)text; *c != 0; ++c)
    if (*c == '"' || *c == '\\')
      fprintf(j->out, "\\%c", *c);
    else if (*c < 0x20)
      fprintf(j->out, "\\u%04x", *c);
    else
      fputc(*c, j->out);
  fputc('"', j->out);
}

static void put_key(json *j, const char *key) {
  if (j->depth > 0) fprintf(j->out, "%s\n%*s", j->first ? "" : ",", 2 * j->depth, "");
  j->first = 0;
  if (key == NULL) return;
  put_text(j, key);
  fputs(": ", j->out);
}

void json_begin(json *j, const char *key, char bracket) {
  put_key(j, key);
  fputc(bracket, j->out);
  ++j->depth;
  j->first = 1;
}

void json_end(json *j, char bracket) {
  --j->depth;
  if (!j->first) fprintf(j->out, "\n%*s", 2 * j->depth, "");
  fputc(bracket, j->out);
  j->first = 0;
  if (j->depth == 0) fputc('\n', j->out);
}

void json_text(json *j, const char *key, const char *text) {
  put_key(j, key);
  put_text(j, text);
}

void json_number(json *j, const char *key, double value) {
  put_key(j, key);
  if (isfinite(value))
    fprintf(j->out, "%.4f", value);
  else
    fputs("null", j->out);
}

void json_count(json *j, const char *key, unsigned long long value) {
  put_key(j, key);
  fprintf(j->out, "%llu", value);
}
