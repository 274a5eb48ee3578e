/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/scene_language/nearest.h"

#include <string.h>

static char lower(char c) { return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c; }
static int least(int a, int b) { return a < b ? a : b; }

int nearest_edits(const char *text, size_t bytes, const char *word) {
  const size_t length = strlen(word);
  int rows[3][NEAREST_BYTES]; /* edits from the first letters of text, those of row % 3, to those of word */
  if (bytes >= NEAREST_BYTES || length >= NEAREST_BYTES) return NEAREST_EDITS + 1;
  for (size_t n = 0; n <= bytes; n++) {
    int *row = rows[n % 3];
    const int *above = rows[(n + 2) % 3];
    const int *second = rows[(n + 1) % 3];
    row[0] = (int)n;
    for (size_t k = 1; k <= length; k++) {
      if (n == 0) {
        row[k] = (int)k;
        continue;
      }
      const int changed = lower(text[n - 1]) != lower(word[k - 1]);
      row[k] = least(above[k - 1] + changed, least(above[k], row[k - 1]) + 1);
      if (n > 1 && k > 1 && lower(text[n - 1]) == lower(word[k - 2]) &&
          lower(text[n - 2]) == lower(word[k - 1]))
        row[k] = least(row[k], second[k - 2] + 1);
    }
  }
  return rows[bytes % 3][length];
}

int nearest_is_near(int edits, size_t bytes) {
  return edits == 0 || (edits <= NEAREST_EDITS && 2 * (size_t)edits < bytes);
}
