/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/font.h"

#include <string.h>

/* One glyph a word, from the space on: bit 5 * row + column, rows from the top. */
static const uint64_t glyphs[95] = {
    0x000000000, 0x100421084, 0x00000294A, 0x295F57D4A, 0x11F4717C4, 0x632222263, 0x593511526,
    0x000000884, 0x208210888, 0x088842082, 0x009575480, 0x0084F9080, 0x088600000, 0x0000F8000,
    0x18C000000, 0x002222200, 0x3A318C62E, 0x3884210C4, 0x7C444422E, 0x3A304111F, 0x211F4A988,
    0x3A3083C3F, 0x3A317844C, 0x08422221F, 0x3A317462E, 0x1910F462E, 0x00C6018C0, 0x0886018C0,
    0x208208888, 0x001F07C00, 0x088882082, 0x10044422E, 0x783DAF62E, 0x4631FC62E, 0x3E317C62F,
    0x3A210862E, 0x1D318C527, 0x7C217843F, 0x04217843F, 0x7A31E862E, 0x4631FC631, 0x38842108E,
    0x19284211C, 0x452519531, 0x7C2108421, 0x4631AD771, 0x4639ACE31, 0x3A318C62E, 0x04217C62F,
    0x59358C62E, 0x45257C62F, 0x3E107043E, 0x10842109F, 0x3A318C631, 0x11518C631, 0x2AB5AC631,
    0x462A22A31, 0x108454631, 0x7C222221F, 0x38421084E, 0x020820820, 0x39084210E, 0x000004544,
    0x7C0000000, 0x000002082, 0x7A3E83800, 0x3E319B421, 0x3A210B800, 0x7A31CDA10, 0x383F8B800,
    0x084238A4C, 0x3A1E8C7C0, 0x46319B421, 0x388421804, 0x192843008, 0x24A32A421, 0x388421086,
    0x4635AAC00, 0x46319B400, 0x3A318B800, 0x042F8BC00, 0x421ECD800, 0x04219B400, 0x3E0E0B800,
    0x324211C42, 0x5B318C400, 0x11518C400, 0x2AB58C400, 0x454454400, 0x3A1E8C400, 0x7C4447C00,
    0x208411088, 0x108421084, 0x088441082, 0x0008A8800};

float font_width(const char *text, float size) {
  const size_t n = strlen(text);
  return n ? ((float)n * FONT_ADVANCE - 1.0f) * size : 0.0f;
}

static void draw_glyph(canvas *c, float x, float y, float size, uint64_t glyph, rgb colour) {
  for (int row = 0; row < FONT_ROWS; row++) {
    for (int column = 0; column < FONT_COLUMNS; column++) {
      /* A run of dots is one box: no seams between dots when size is not whole. */
      int run = 0;
      while (column + run < FONT_COLUMNS && (glyph >> (row * FONT_COLUMNS + column + run) & 1u))
        run++;
      if (run == 0) continue;
      const float left = x + (float)column * size, top = y + (float)row * size;
      canvas_box(c, left, top, left + (float)run * size, top + size, colour, 1.0f);
      column += run;
    }
  }
}

void font_draw(canvas *c, float x, float y, float size, const char *text, rgb colour,
               font_align align) {
  if (align != FONT_LEFT) x -= font_width(text, size) * (align == FONT_CENTRE ? 0.5f : 1.0f);
  for (; *text; text++, x += FONT_ADVANCE * size) {
    const unsigned code = (unsigned char)*text;
    const uint64_t glyph = glyphs[code >= 32 && code < 127 ? code - 32u : (unsigned)'?' - 32u];
    draw_glyph(c, x, y, size, glyph, colour);
  }
}

void font_draw_upwards(canvas *c, float x, float y, float size, const char *text, rgb colour) {
  y += font_width(text, size) * 0.5f;
  for (; *text; text++, y -= FONT_ADVANCE * size) {
    const unsigned code = (unsigned char)*text;
    const uint64_t glyph = glyphs[code >= 32 && code < 127 ? code - 32u : (unsigned)'?' - 32u];
    for (int bit = 0; bit < FONT_ROWS * FONT_COLUMNS; bit++) {
      if (!(glyph >> bit & 1u)) continue;
      const float left = x + (float)(bit / FONT_COLUMNS) * size;
      const float low = y - (float)(bit % FONT_COLUMNS) * size;
      canvas_box(c, left, low - size, left + size, low, colour, 1.0f);
    }
  }
}
