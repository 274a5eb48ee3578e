/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L

#include "tools/render/album.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "tools/progress.h"
#include "tools/render/montage.h"
#include "tools/render/picture.h"

enum { SAMPLES = 2, TILE_WIDTH = 480, PATH_ROOM = 1024 };

void album_open(album *a) { memset(a, 0, sizeof *a); }

int album_add(album *a, const fray_world *world) {
  if (a->count == ALBUM_PICTURES_MAX) return 0;
  if (a->count == a->room) {
    const size_t room = a->room == 0 ? 16 : a->room * 2;
    picture_source *grown = realloc(a->pictures, room * sizeof *grown);
    if (grown == NULL) return 0;
    a->pictures = grown;
    a->room = room;
  }
  memset(&a->pictures[a->count], 0, sizeof a->pictures[0]);
  if (!picture_source_read(&a->pictures[a->count], world)) return 0;
  ++a->count;
  return 1;
}

void album_close(album *a) {
  for (size_t n = 0; n < a->count; ++n) picture_source_close(&a->pictures[n]);
  free(a->pictures);
  album_open(a);
}

int album_make_folder(const char *path) {
  char part[PATH_ROOM];
  const size_t n = strlen(path);
  if (n == 0 || n + 32 > sizeof part) {
    fprintf(stderr, "%s: not a good name for a folder\n", path);
    return 0;
  }
  for (size_t k = 1; k <= n; ++k) {
    if (path[k] != '/' && path[k] != 0) continue;
    memcpy(part, path, k);
    part[k] = 0;
    if (mkdir(part, 0777) != 0 && errno != EEXIST) {
      fprintf(stderr, "%s: cannot be made: %s\n", part, strerror(errno));
      return 0;
    }
  }
  return 1;
}

static bounds album_bounds(const album *a) {
  bounds extent = bounds_none();
  for (size_t n = 0; n < a->count; ++n)
    bounds_join(&extent, picture_source_bounds(&a->pictures[n]));
  return a->count > 0 ? bounds_within(extent, picture_source_bounds(&a->pictures[0])) : extent;
}

static int write_one(const picture_source *p, const album_style *s, canvas *c, const camera *cam,
                     bounds extent, montage *sheet) {
  char caption[MONTAGE_CAPTION];
  char path[PATH_ROOM];
  picture_style style = picture_style_default(extent, s->look);
  style.cloth.strain = s->strain;
  style.caption = caption;
  snprintf(caption, sizeof caption, "tick %u  %.3f s", p->tick, (double)p->tick / p->rate_hz);
  snprintf(path, sizeof path, "%s/frame_%05u.png", s->folder, p->tick);
  errno = ENOMEM;
  if (picture_draw(c, cam, p, &style) && canvas_write(c, path) && montage_add(sheet, c, caption))
    return 1;
  fprintf(stderr, "%s: cannot be written: %s\n", path, strerror(errno));
  return 0;
}

static int write_sheet(const montage *sheet, const char *folder) {
  char path[PATH_ROOM];
  snprintf(path, sizeof path, "%s/sheet.png", folder);
  if (montage_write(sheet, 0, path)) return 1;
  fprintf(stderr, "%s: cannot be written: %s\n", path, strerror(errno));
  return 0;
}

static camera album_camera(const album_style *s, bounds extent) {
  if (s->has_focus) {
    const v3 reach = {s->reach, s->reach, s->reach};
    extent = (bounds){v3_sub(s->focus, reach), v3_add(s->focus, reach)};
  }
  return s->has_view ? camera_frame(extent, s->yaw, s->pitch, s->width, s->height)
                     : camera_default(extent, s->width, s->height);
}

int album_write(const album *a, const album_style *s) {
  const bounds extent = album_bounds(a);
  canvas c;
  montage sheet;
  if (!album_make_folder(s->folder)) return 0;
  if (!canvas_open(&c, s->width, s->height, SAMPLES)) {
    fprintf(stderr, "%ux%u: not enough memory for pictures of this size\n", s->width, s->height);
    return 0;
  }
  const camera cam = album_camera(s, extent);
  montage_open(&sheet, s->width, s->height, TILE_WIDTH);
  int good = 1;
  for (size_t n = 0; good && n < a->count; ++n) {
    good = write_one(&a->pictures[n], s, &c, &cam, extent, &sheet);
    progress_show("draw", (uint32_t)n + 1, (uint32_t)a->count);
  }
  progress_end();
  good = good && write_sheet(&sheet, s->folder);
  montage_close(&sheet);
  canvas_close(&c);
  return good;
}
