/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/montage.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/render/font.h"
#include "tools/render/png.h"

enum { GAP = 6, CAPTION = 24, SIDE_MAX = 16384 };

void montage_open(montage *m, uint32_t picture_width, uint32_t picture_height,
                  uint32_t tile_width) {
  memset(m, 0, sizeof *m);
  const uint32_t factor = tile_width ? (picture_width + tile_width - 1) / tile_width : 1;
  m->width = picture_width / (factor ? factor : 1);
  m->height = picture_height / (factor ? factor : 1);
}

void montage_close(montage *m) {
  for (size_t k = 0; k < m->count; k++) free(m->tiles[k].rgb);
  free(m->tiles);
  memset(m, 0, sizeof *m);
}

static int make_room(montage *m) {
  if (m->count < m->room) return 1;
  const size_t room = m->room ? 2 * m->room : 16;
  montage_tile *grown = realloc(m->tiles, room * sizeof *grown);
  if (!grown) return 0;
  m->tiles = grown;
  m->room = room;
  return 1;
}

/* A shrunk copy in linear light, by the canvas's own filter: a view with a coarser scale. */
static int shrink(const montage *m, const canvas *picture, uint8_t *out) {
  const uint32_t factor = picture->width / m->width, s = factor * picture->scale;
  canvas small;
  if (!canvas_open(&small, m->width, m->height, 1)) return 0;
  const float norm = 1.0f / (float)(s * s);
  for (uint32_t y = 0; y < m->height; y++) {
    for (uint32_t x = 0; x < m->width; x++) {
      float sum[3] = {0};
      for (uint32_t dy = 0; dy < s; dy++) {
        const uint16_t *p =
            picture->light + 3 * ((size_t)(y * s + dy) * picture->columns + (size_t)x * s);
        for (uint32_t k = 0; k < 3 * s; k++) sum[k % 3] += (float)p[k];
      }
      uint16_t *to = small.light + 3 * ((size_t)y * m->width + x);
      for (int k = 0; k < 3; k++) to[k] = (uint16_t)(sum[k] * norm + 0.5f);
    }
  }
  canvas_resolve(&small, out);
  canvas_close(&small);
  return 1;
}

int montage_add(montage *m, const canvas *picture, const char *caption) {
  if (!make_room(m) || m->width == 0 || m->height == 0) return 0;
  montage_tile *tile = m->tiles + m->count;
  tile->rgb = malloc((size_t)m->width * m->height * 3);
  if (!tile->rgb) return 0;
  if (!shrink(m, picture, tile->rgb)) {
    free(tile->rgb);
    return 0;
  }
  snprintf(tile->caption, sizeof tile->caption, "%s", caption);
  m->count++;
  return 1;
}

static void paste(uint8_t *sheet, uint32_t sheet_width, uint32_t x, uint32_t y,
                  const uint8_t *rgb_rows, uint32_t width, uint32_t height) {
  for (uint32_t row = 0; row < height; row++)
    memcpy(sheet + 3 * ((size_t)(y + row) * sheet_width + x), rgb_rows + 3 * (size_t)row * width,
           (size_t)width * 3);
}

/* The paper and the captions; the tiles are pasted over it. */
static int draw_captions(const montage *m, uint32_t columns, uint32_t width, uint32_t height,
                         uint8_t *sheet) {
  canvas c;
  if (!canvas_open(&c, width, height, 1)) return 0;
  canvas_fill(&c, rgb_hex(0xFFFFFF), rgb_hex(0xFFFFFF));
  for (size_t k = 0; k < m->count; k++) {
    const size_t x = GAP + k % columns * (m->width + GAP);
    const size_t y = GAP + k / columns * (m->height + CAPTION);
    const float dots = font_width(m->tiles[k].caption, 2.0f) <= (float)m->width ? 2.0f : 1.0f;
    font_draw(&c, (float)x + 2.0f, (float)(y + m->height) + 4.0f, dots, m->tiles[k].caption,
              rgb_hex(0x30363D), FONT_LEFT);
  }
  canvas_resolve(&c, sheet);
  canvas_close(&c);
  return 1;
}

int montage_write(const montage *m, uint32_t columns, const char *path) {
  errno = EINVAL;
  if (m->count == 0) return 0;
  if (columns == 0) {
    const double square = sqrt((double)m->count * m->height / m->width);
    columns = (uint32_t)ceil(square - 1e-9);
  }
  if (columns > m->count) columns = (uint32_t)m->count;
  if (columns < 1) columns = 1;
  const size_t rows = (m->count + columns - 1) / columns;
  const size_t width = GAP + (size_t)columns * (m->width + GAP);
  const size_t height = GAP + rows * (m->height + CAPTION);
  if (width > SIDE_MAX || height > SIDE_MAX) {
    errno = EFBIG;
    return 0;
  }
  errno = ENOMEM;
  uint8_t *sheet = malloc(width * height * 3);
  int good = sheet && draw_captions(m, columns, (uint32_t)width, (uint32_t)height, sheet);
  for (size_t k = 0; good && k < m->count; k++) {
    const size_t x = GAP + k % columns * (m->width + GAP);
    const size_t y = GAP + k / columns * (m->height + CAPTION);
    paste(sheet, (uint32_t)width, (uint32_t)x, (uint32_t)y, m->tiles[k].rgb, m->width, m->height);
  }
  good = good && png_write(path, sheet, (uint32_t)width, (uint32_t)height);
  free(sheet);
  return good;
}
