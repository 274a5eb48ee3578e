/* SPDX-License-Identifier: Apache-2.0 */
#define _POSIX_C_SOURCE 200809L

#include "tools/render/album.h"

#include <errno.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "platform/files/output_file.h"
#include "tools/terminal/progress.h"
#include "tools/render/montage.h"
#include "tools/render/picture.h"

enum { SAMPLES = 2, TILE_WIDTH = 480, PATH_ROOM = 1024, ROW_MOMENTS = 5, PAIR_COLUMNS = 4, PAINTERS_MAX = 4 };

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

/* Pictures are drawn by some threads, a canvas each, and put on the contact sheet in their order. */
typedef struct {
  const album *a;
  const album_style *style;
  camera cam;
  bounds extent;
  montage contact_sheet;
  cloth_look looks[2];
  size_t kinds;         /* looks of a moment */
  int rows;             /* a row of the contact sheet for each look */
  pthread_mutex_t lock; /* of all below, and of the contact sheet */
  pthread_cond_t put;   /* in_order or good has changed */
  size_t next;          /* picture to draw */
  size_t in_order;      /* pictures drawn and put on the contact sheet, or left out of it */
  int good;
  int is_ended;         /* before its last picture */
} album_job;

/* Whether picture n is one of at most ALBUM_CONTACT_SHEET_MAX, the first and the last among them. */
static int is_on_contact_sheet(size_t n, size_t count) {
  if (count <= ALBUM_CONTACT_SHEET_MAX) return 1;
  const size_t steps = ALBUM_CONTACT_SHEET_MAX - 1, last = count - 1;
  const size_t step = (n * steps + last - 1) / last;
  return step * last / steps == n;
}

static size_t pictures_of(const album_job *k) { return k->a->count * k->kinds; }

static size_t moment_of(const album_job *k, size_t n) { return k->rows ? n % k->a->count : n / k->kinds; }

/* The next picture; pictures_of() where none is left, one has failed, or the album is to end. */
static size_t take_picture(album_job *k) {
  pthread_mutex_lock(&k->lock);
  if (k->next < pictures_of(k) && k->style->asked_to_end != NULL && k->style->asked_to_end() != 0) {
    k->is_ended = 1;
    k->next = pictures_of(k);
  }
  const size_t n = k->good && k->next < pictures_of(k) ? k->next++ : pictures_of(k);
  pthread_mutex_unlock(&k->lock);
  return n;
}

/* After the pictures before it. */
static int put_picture(album_job *k, size_t n, const canvas *c, const char *caption, int drawn) {
  pthread_mutex_lock(&k->lock);
  while (drawn && k->good && k->in_order != n) pthread_cond_wait(&k->put, &k->lock);
  const int is_on_sheet = is_on_contact_sheet(moment_of(k, n), k->a->count);
  if (k->good && drawn && is_on_sheet) drawn = montage_add(&k->contact_sheet, c, caption);
  if (drawn) ++k->in_order;
  k->good = k->good && drawn;
  if (k->good) progress_show("draw", (uint32_t)k->in_order, (uint32_t)pictures_of(k));
  pthread_cond_broadcast(&k->put);
  pthread_mutex_unlock(&k->lock);
  return drawn;
}

static void write_one(album_job *k, size_t n, canvas *c) {
  char caption[MONTAGE_CAPTION];
  char path[PATH_ROOM];
  const picture_source *p = &k->a->pictures[moment_of(k, n)];
  const cloth_look look = k->looks[k->rows ? n / k->a->count : n % k->kinds];
  const int beside = look == LOOK_WIRE && k->style->yarn;
  picture_style style = picture_style_default(k->extent, look);
  style.cloth.strain = k->style->strain;
  style.caption = caption;
  snprintf(caption, sizeof caption, "tick %" PRIu64 "  %.3f s", p->tick, (double)p->tick / p->rate_hz);
  snprintf(path, sizeof path, "%s/%s_%05" PRIu64 ".png", k->style->folder, beside ? "wire" : "frame",
           p->tick);
  errno = ENOMEM;
  const int drawn = picture_draw(c, &k->cam, p, &style) && canvas_write(c, path);
  const int reason = errno;
  if (!put_picture(k, n, c, caption, drawn)) {
    errno = drawn ? ENOMEM : reason;
    fprintf(stderr, "%s: cannot be written: %s\n", path, output_file_reason());
  }
}

static void *paint(void *job) {
  album_job *k = job;
  canvas c;
  if (!canvas_open(&c, k->style->width, k->style->height, SAMPLES)) return NULL;
  for (size_t n = take_picture(k); n < pictures_of(k); n = take_picture(k)) write_one(k, n, &c);
  canvas_close(&c);
  return NULL;
}

/* The caller is one of the painters and joins the others. A thread that does not start, or has no memory for its
 * canvas, draws nothing. */
static int write_all(album_job *k, canvas *own) {
  pthread_t painters[PAINTERS_MAX - 1];
  const long cpus = sysconf(_SC_NPROCESSORS_ONLN);
  size_t wanted = cpus < 1 ? 1 : cpus > PAINTERS_MAX ? PAINTERS_MAX : (size_t)cpus, started = 0;
  if (wanted > pictures_of(k)) wanted = pictures_of(k);
  while (started + 1 < wanted && pthread_create(&painters[started], NULL, paint, k) == 0) ++started;
  for (size_t n = take_picture(k); n < pictures_of(k); n = take_picture(k)) write_one(k, n, own);
  for (size_t n = 0; n < started; ++n) pthread_join(painters[n], NULL);
  return k->good;
}

/* Few moments in two looks stand in two rows, the looks below each other; many in pairs. Returns the columns. */
static size_t choose_looks(album_job *k) {
  const album_style *s = k->style;
  const size_t count = k->a->count;
  k->kinds = s->yarn && s->wire ? 2 : 1;
  k->looks[0] = s->yarn ? LOOK_YARN : s->wire ? LOOK_WIRE : LOOK_SURFACE;
  k->looks[1] = LOOK_WIRE;
  k->rows = k->kinds == 2 && count <= ROW_MOMENTS;
  return k->kinds == 1 ? 0 : k->rows ? count : PAIR_COLUMNS;
}

static int write_contact_sheet(const montage *contact_sheet, size_t columns, const char *folder) {
  char path[PATH_ROOM];
  snprintf(path, sizeof path, "%s/sheet.png", folder);
  if (montage_write(contact_sheet, (uint32_t)columns, path)) return 1;
  fprintf(stderr, "%s: cannot be written: %s\n", path, output_file_reason());
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
  album_job k = {.a = a, .style = s, .extent = album_bounds(a), .good = 1};
  canvas own;
  if (!album_make_folder(s->folder)) return 0;
  if (!canvas_open(&own, s->width, s->height, SAMPLES)) {
    fprintf(stderr, "%ux%u: not enough memory for pictures of this size\n", s->width, s->height);
    return 0;
  }
  k.cam = album_camera(s, k.extent);
  const size_t columns = choose_looks(&k);
  montage_open(&k.contact_sheet, s->width, s->height, TILE_WIDTH);
  pthread_mutex_init(&k.lock, NULL);
  pthread_cond_init(&k.put, NULL);
  int good = write_all(&k, &own);
  progress_end();
  pthread_cond_destroy(&k.put);
  pthread_mutex_destroy(&k.lock);
  good = good && (k.is_ended || write_contact_sheet(&k.contact_sheet, columns, s->folder));
  montage_close(&k.contact_sheet);
  canvas_close(&own);
  return good;
}
