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

enum { SAMPLES = 2, TILE_WIDTH = 480, PATH_ROOM = 1024, ROW_MOMENTS = 5, PAIR_COLUMNS = 4 };

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

typedef struct {
  const album *a;
  const album_style *style;
  canvas c;
  camera cam;
  bounds extent;
  montage sheet;
} album_job;

static int write_one(album_job *k, const picture_source *p, cloth_look look, int on_sheet) {
  char caption[MONTAGE_CAPTION];
  char path[PATH_ROOM];
  const int beside = look == LOOK_WIRE && k->style->yarn;
  picture_style style = picture_style_default(k->extent, look);
  style.cloth.strain = k->style->strain;
  style.caption = caption;
  snprintf(caption, sizeof caption, "tick %u  %.3f s", p->tick, (double)p->tick / p->rate_hz);
  snprintf(path, sizeof path, "%s/%s_%05u.png", k->style->folder, beside ? "wire" : "frame",
           p->tick);
  errno = ENOMEM;
  if (picture_draw(&k->c, &k->cam, p, &style) && canvas_write(&k->c, path) &&
      (!on_sheet || montage_add(&k->sheet, &k->c, caption))) {
    return 1;
  }
  fprintf(stderr, "%s: cannot be written: %s\n", path, strerror(errno));
  return 0;
}

/* Whether picture n is one of at most ALBUM_SHEET_MOMENTS, the first and the last among them. */
static int is_on_sheet(size_t n, size_t count) {
  if (count <= ALBUM_SHEET_MOMENTS) return 1;
  const size_t steps = ALBUM_SHEET_MOMENTS - 1, last = count - 1;
  const size_t step = (n * steps + last - 1) / last;
  return step * last / steps == n;
}

/* Few moments in two looks stand in two rows, the looks below each other; many in pairs. */
static int write_all(album_job *k, size_t *columns) {
  const album_style *s = k->style;
  cloth_look looks[2] = {LOOK_SHEET, LOOK_WIRE};
  const size_t count = k->a->count, kinds = s->yarn && s->wire ? 2 : 1;
  if (s->wire) looks[0] = LOOK_WIRE;
  if (s->yarn) looks[0] = LOOK_YARN;
  const int rows = kinds == 2 && count <= ROW_MOMENTS;
  *columns = kinds == 1 ? 0 : rows ? count : PAIR_COLUMNS;
  for (size_t n = 0; n < count * kinds; ++n) {
    const size_t moment = rows ? n % count : n / kinds, look = rows ? n / count : n % kinds;
    if (!write_one(k, &k->a->pictures[moment], looks[look], is_on_sheet(moment, count))) return 0;
    progress_show("draw", (uint32_t)n + 1, (uint32_t)(count * kinds));
  }
  return 1;
}

static int write_sheet(const montage *sheet, size_t columns, const char *folder) {
  char path[PATH_ROOM];
  snprintf(path, sizeof path, "%s/sheet.png", folder);
  if (montage_write(sheet, (uint32_t)columns, path)) return 1;
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
  album_job k = {.a = a, .style = s, .extent = album_bounds(a)};
  size_t columns = 0;
  if (!album_make_folder(s->folder)) return 0;
  if (!canvas_open(&k.c, s->width, s->height, SAMPLES)) {
    fprintf(stderr, "%ux%u: not enough memory for pictures of this size\n", s->width, s->height);
    return 0;
  }
  k.cam = album_camera(s, k.extent);
  montage_open(&k.sheet, s->width, s->height, TILE_WIDTH);
  int good = write_all(&k, &columns);
  progress_end();
  good = good && write_sheet(&k.sheet, columns, s->folder);
  montage_close(&k.sheet);
  canvas_close(&k.c);
  return good;
}
