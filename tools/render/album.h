/* SPDX-License-Identifier: Apache-2.0 */
/* The pictures of one run: moments are kept as they pass, and drawn when all are known, so that
 * one camera frames them all. */
#ifndef FRAY_TOOLS_RENDER_ALBUM_H
#define FRAY_TOOLS_RENDER_ALBUM_H

#include <stddef.h>

#include "tools/render/cloth_style.h"
#include "tools/render/picture_source.h"

enum { ALBUM_PICTURES_MAX = 5000, ALBUM_CONTACT_SHEET_MAX = 48 };

typedef struct {
  picture_source *pictures;
  size_t count, room;
} album;

typedef struct {
  const char *folder;
  uint32_t width, height;
  int has_view;      /* else chosen from the pictures */
  float yaw, pitch;  /* degrees */
  int has_focus;     /* else all of the run is framed */
  v3 focus;          /* mm */
  float reach;       /* mm: what the camera frames about the focus */
  int strain;        /* colour by strain */
  int yarn, wire;    /* how the cloth is shown; both: each moment in two pictures */
  int (*asked_to_end)(void); /* by several threads, before each picture: nonzero: no more; NULL: never */
} album_style;

void album_open(album *a);
/* Keeps the world as it stands. Returns 0 iff memory ran out or the album is full. */
int album_add(album *a, const fray_world *world);
/* Writes FOLDER/frame_<ticks>.png and FOLDER/sheet.png, which has all of them, or, of more than
 * ALBUM_CONTACT_SHEET_MAX, so many at even steps; makes the folder. With yarns and wires, the wires are
 * FOLDER/wire_<ticks>.png. Where it was asked to end, the pictures so far and no sheet. Returns 1, or 0 after a
 * message to stderr. */
int album_write(const album *a, const album_style *style);
void album_close(album *a);

/* Makes a folder and those above it. Returns 1, or 0 after a message to stderr. */
int album_make_folder(const char *path);

#endif
