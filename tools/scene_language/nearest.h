/* SPDX-License-Identifier: Apache-2.0 */
/* The known word that a misspelt one is nearest to. */
#ifndef FRAY_TOOLS_SCENE_LANGUAGE_NEAREST_H
#define FRAY_TOOLS_SCENE_LANGUAGE_NEAREST_H

#include <stddef.h>

enum { NEAREST_EDITS = 2, NEAREST_BYTES = 32 };

/* Edits that make one of the other: letters put in, left out, changed (case is none) or swapped with the
 * next. Above NEAREST_EDITS: more than that, or a word of NEAREST_BYTES or more. */
int nearest_edits(const char *text, size_t bytes, const char *word);
/* So few edits that the word may be meant: at most 2, and less than half of the letters. */
int nearest_is_near(int edits, size_t bytes);

#endif
