/* SPDX-License-Identifier: Apache-2.0 */
/* A bitmap font of 5 x 7 dots, ASCII 32 to 126; anything else is drawn as `?`. */
#ifndef FRAY_TOOLS_RENDER_FONT_H
#define FRAY_TOOLS_RENDER_FONT_H

#include "tools/render/canvas.h"

enum { FONT_COLUMNS = 5, FONT_ROWS = 7, FONT_ADVANCE = 6 };
typedef enum { FONT_LEFT, FONT_CENTRE, FONT_RIGHT } font_align;

/* `size` is pixels per dot; 2 reads well. (x, y): top left, centre or right of the text. */
float font_width(const char *text, float size);
void font_draw(canvas *c, float x, float y, float size, const char *text, rgb colour,
               font_align align);
/* Turned to read upwards, centred on y; x is its left edge. */
void font_draw_upwards(canvas *c, float x, float y, float size, const char *text, rgb colour);

#endif
