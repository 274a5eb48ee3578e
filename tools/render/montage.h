/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of one size, tiled with captions into one: a run at a glance. */
#ifndef FRAY_TOOLS_RENDER_MONTAGE_H
#define FRAY_TOOLS_RENDER_MONTAGE_H

#include <stddef.h>
#include <stdint.h>

#include "tools/render/canvas.h"

enum { MONTAGE_CAPTION = 64 };

typedef struct {
  uint8_t *rgb; /* width * height * 3 */
  char caption[MONTAGE_CAPTION];
} montage_tile;

typedef struct {
  uint32_t width, height; /* of a tile, without its caption */
  montage_tile *tiles;
  size_t count, room;
} montage;

/* Tiles are `picture_width` x `picture_height` shrunk by a whole factor to at most `tile_width`. */
void montage_open(montage *m, uint32_t picture_width, uint32_t picture_height, uint32_t tile_width);
/* Takes a shrunk copy; the picture must have the size that montage_open() was told.
 * Returns 0 iff memory ran out. */
int montage_add(montage *m, const canvas *picture, const char *caption);
/* `columns` 0: about as wide as high. Returns 1, or 0 with errno set. */
int montage_write(const montage *m, uint32_t columns, const char *path);
void montage_close(montage *m);

#endif
