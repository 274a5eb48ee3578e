/* SPDX-License-Identifier: Apache-2.0 */
/* Words of scenes and hand scripts: runs of printable characters between blanks, braces and comments. */
#ifndef FRAY_TOOLS_SCENE_LANGUAGE_LEXER_H
#define FRAY_TOOLS_SCENE_LANGUAGE_LEXER_H

#include <stddef.h>

typedef enum { TOKEN_WORD, TOKEN_OPEN, TOKEN_CLOSE, TOKEN_END } token_kind;

typedef struct {
  token_kind kind;
  const char *text; /* into the text, not terminated */
  size_t bytes;
  int line, column; /* from 1 */
  int first;        /* of its line */
} token;

typedef struct {
  const char *text;
  size_t bytes, at, line_start;
  int line;
  int end_line, end_column; /* the end of the token before the current one ... */
  size_t end;               /* ... as an offset in the text */
  token token;              /* the current one */
} lexer;

/* Returns 1 iff every byte is printable ASCII, a blank or a line end; else 0 and the place. */
int lexer_readable(const char *text, size_t bytes, int *line, int *column, unsigned *byte);

/* Starts on the first token. The text outlives the lexer; lines and columns fit int. */
void lexer_start(lexer *l, const char *text, size_t bytes);
void lexer_next(lexer *l);

/* Drops the first bytes of the current word; the next token if nothing is left. */
void lexer_drop(lexer *l, size_t bytes);

/* Returns 1 iff the token is this word. */
int lexer_is(const token *t, const char *word);

#endif
