/* SPDX-License-Identifier: Apache-2.0 */
#include "tests/wild/shrink.h"

#include <string.h>

/* The end of the block that begins in this line, or of the line. */
static const char *end_of(const char *at) {
  int depth = 0;
  for (; *at != 0; ++at) {
    depth += (*at == '{') - (*at == '}');
    if (*at == '\n' && depth <= 0) return at + 1;
  }
  return at;
}

static uint32_t lines_of(const char *from, const char *end) {
  uint32_t lines = 0;
  for (; from != end; ++from) lines += *from == '\n';
  return lines;
}

static int still_found(const char *text, const judge_run *run, uint32_t kind, double seconds) {
  judge_result r;
  judge_run again = *run;
  again.seconds = seconds;
  again.wanted = 1u << kind;
  again.record = NULL;
  judge_scene(text, &again, &r);
  return r.refused[0] == 0 && (r.found >> kind & 1u) != 0;
}

/* Whole blocks first, from the last on; then lines in blocks. A key that is needed makes the rest
 * refused. */
uint32_t shrink_scene(char *text, const judge_run *run, uint32_t kind, double seconds,
                      uint32_t tries) {
  static char shorter[RANDOM_SCENE_ROOM];
  uint32_t gone = 0;
  for (int inside = 0; inside < 2; ++inside) {
    size_t at = 0;
    while (text[at] != 0 && tries > 0) {
      const int is_inside = text[at] == ' ' || text[at] == '}';
      const char *end = inside ? strchr(text + at, '\n') : end_of(text + at);
      end = end == NULL ? text + strlen(text) : inside ? end + 1 : end;
      const size_t next = (size_t)(end - text);
      if (is_inside == inside && text[at] != '}' &&
          !(inside == 1 && strchr(text + at, '{') != NULL && strchr(text + at, '{') < end)) {
        memcpy(shorter, text, at);
        strcpy(shorter + at, end);
        --tries;
        if (still_found(shorter, run, kind, seconds)) {
          gone += lines_of(text + at, end);
          memcpy(text, shorter, strlen(shorter) + 1);
          continue;
        }
      }
      at = next;
    }
  }
  return gone;
}
