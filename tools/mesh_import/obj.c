/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/mesh_import/obj.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/files/input_file.h"
#include "tools/scene_language/number.h"

typedef struct {
  const char *text;
  size_t bytes;
  int line, column;
} word;

typedef struct {
  const char *file;
  const char *text;
  size_t bytes, at, line_start;
  int line;
  int ended; /* after the last word of a line */
  obj_mesh *mesh;
  uint32_t point_room, triangle_room, mark_room;
  scene_error *error;
} reader;

int obj_refuse(scene_error *error, const char *file, int line, int column, const char *format, ...) {
  va_list list;
  snprintf(error->file, sizeof error->file, "%s", file);
  error->line = line;
  error->column = column;
  va_start(list, format);
  vsnprintf(error->message, sizeof error->message, format, list);
  va_end(list);
  return 0;
}

/* "found 'WORD', expected ...", shortened and printable. */
static int fail(const reader *r, const word *w, const char *expected) {
  char shown[33];
  size_t n = 0;
  if (w->bytes == 0)
    return obj_refuse(r->error, r->file, w->line, w->column, "found the end of the line, expected %s",
                      expected);
  for (; n < w->bytes && n + 1 < sizeof shown; ++n)
    shown[n] = w->text[n] > ' ' && w->text[n] < 127 ? w->text[n] : '?';
  shown[n] = 0;
  return obj_refuse(r->error, r->file, w->line, w->column, "found '%s%s', expected %s", shown,
                    n < w->bytes ? "..." : "", expected);
}

static int line_goes_on(const reader *r) {
  const size_t left = r->bytes - r->at;
  const char *t = r->text + r->at;
  return t[0] == '\\' && (left == 1 || t[1] == '\n' || (t[1] == '\r' && left > 2 && t[2] == '\n'));
}
static void new_line(reader *r) {
  while (r->at < r->bytes && r->text[r->at] != '\n') ++r->at;
  if (r->at < r->bytes) ++r->at;
  r->line_start = r->at;
  ++r->line;
}
static int is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/* The next word of the line; 0 bytes: there is none. */
static word next_word(reader *r) {
  while (!r->ended && r->at < r->bytes) {
    if (line_goes_on(r))
      new_line(r);
    else if (is_blank(r->text[r->at]))
      ++r->at;
    else
      break;
  }
  if (r->at == r->bytes || r->text[r->at] == '\n' || r->text[r->at] == '#') r->ended = 1;
  word w = {r->text + r->at, 0, r->line, (int)(r->at - r->line_start) + 1};
  while (!r->ended && r->at < r->bytes && !is_blank(r->text[r->at]) && r->text[r->at] != '\n' &&
         r->text[r->at] != '#' && !line_goes_on(r)) {
    ++w.bytes;
    ++r->at;
  }
  return w;
}

static int word_is(const word *w, const char *name) {
  return w->bytes == strlen(name) && memcmp(w->text, name, w->bytes) == 0;
}

/* Grows a list for one more element. Returns NULL, with the error filled, where it cannot. */
static void *room_for(const reader *r, void *list, uint32_t count, uint32_t *room, uint32_t max,
                      size_t size, const word *at, const char *what) {
  if (count < *room) return list;
  if (count == max) {
    obj_refuse(r->error, r->file, at->line, at->column, "found too many, expected at most %u %s", max,
               what);
    return NULL;
  }
  const uint32_t wanted = *room == 0 ? 64u : 2u * *room;
  void *grown = realloc(list, wanted * size);
  if (grown == NULL)
    obj_refuse(r->error, r->file, at->line, at->column, "not enough memory for %u %s", wanted, what);
  else
    *room = wanted;
  return grown;
}

static int read_number(const reader *r, const word *w, exact *value) {
  size_t used = 0;
  const number_status status = number_read(w->text, w->bytes, value, &used);
  if (status == NUMBER_GOOD && used == w->bytes) return 1;
  if (status == NUMBER_LONG) return fail(r, w, "a number of at most 18 digits");
  if (status == NUMBER_EXTREME) return fail(r, w, "a number that is neither so large nor so small");
  return fail(r, w, "a number");
}

static int read_point(reader *r, const word *key) {
  exact numbers[6];
  int count = 0;
  word w = next_word(r);
  for (; w.bytes != 0 && count < 6; w = next_word(r))
    if (!read_number(r, &w, &numbers[count++])) return 0;
  if (w.bytes != 0) return fail(r, &w, "at most 6 numbers for 'v'");
  if (count != 3 && count != 4 && count != 6) return fail(r, &w, "3 numbers for 'v'");
  if (count == 4 && exact_compare(numbers[3], exact_make(1, 1)) != 0)
    return obj_refuse(r->error, r->file, key->line, key->column,
                      "found a fourth number that is not 1, expected a point of a polygon mesh");
  obj_mesh *m = r->mesh;
  obj_point *points = room_for(r, m->points, m->point_count, &r->point_room, OBJ_POINTS_MAX,
                               sizeof *points, key, "points");
  if (points == NULL) return 0;
  m->points = points;
  memcpy(points[m->point_count].at, numbers, sizeof points->at);
  points[m->point_count++].line = key->line;
  return 1;
}

/* A whole number other than 0, from *at on. */
static int read_whole(const word *w, size_t *at, int64_t *value) {
  const int negative = *at < w->bytes && w->text[*at] == '-';
  *at += negative ? 1u : 0u;
  const size_t first = *at;
  *value = 0;
  while (*at < w->bytes && w->text[*at] >= '0' && w->text[*at] <= '9') {
    if (*value <= INT32_MAX) *value = *value * 10 + (w->text[*at] - '0');
    ++*at;
  }
  if (negative) *value = -*value;
  return *at > first && *value != 0;
}

/* a, a/t, a//n, a/t/n: the number of a point in an earlier line. */
static int read_corner(const reader *r, const word *w, uint32_t *point) {
  static const char expected[] = "the number of a point of an earlier line, from 1 or below 0";
  const int64_t count = r->mesh->point_count;
  size_t at = 0;
  int64_t value = 0;
  int64_t unused = 0;
  if (!read_whole(w, &at, &value)) return fail(r, w, expected);
  for (int part = 0; part < 2 && at < w->bytes && w->text[at] == '/'; ++part) {
    ++at;
    if (part == 0 && at < w->bytes && w->text[at] == '/') continue;
    if (!read_whole(w, &at, &unused)) return fail(r, w, "a corner as 1, 1/2, 1//3 or 1/2/3");
  }
  if (at != w->bytes) return fail(r, w, "a corner as 1, 1/2, 1//3 or 1/2/3");
  if (value < 0) value += count + 1;
  if (value < 1 || value > count) return fail(r, w, expected);
  *point = (uint32_t)(value - 1);
  return 1;
}

static int add_triangle(reader *r, const word *key, uint32_t a, uint32_t b, uint32_t c) {
  obj_mesh *m = r->mesh;
  obj_triangle *triangles = room_for(r, m->triangles, m->triangle_count, &r->triangle_room,
                                     OBJ_TRIANGLES_MAX, sizeof *triangles, key, "triangles");
  if (triangles == NULL) return 0;
  m->triangles = triangles;
  const obj_triangle t = {{a, b, c}, m->face_count, key->line};
  triangles[m->triangle_count++] = t;
  return 1;
}

static int read_face(reader *r, const word *key) {
  uint32_t corners[OBJ_CORNERS_MAX];
  uint32_t count = 0;
  word w = next_word(r);
  for (; w.bytes != 0; w = next_word(r)) {
    if (count == OBJ_CORNERS_MAX) return fail(r, &w, "at most 64 corners of a face");
    if (!read_corner(r, &w, &corners[count])) return 0;
    for (uint32_t n = 0; n < count; ++n)
      if (corners[n] == corners[count]) return fail(r, &w, "each corner of a face once");
    ++count;
  }
  if (count < 3) return fail(r, &w, "at least 3 corners for 'f'");
  for (uint32_t n = 1; n + 1 < count; ++n)
    if (!add_triangle(r, key, corners[0], corners[n], corners[n + 1])) return 0;
  ++r->mesh->face_count;
  return 1;
}

static int add_mark(reader *r, const word *key, uint32_t a, uint32_t b) {
  obj_mesh *m = r->mesh;
  obj_mark *marks = room_for(r, m->marks, m->mark_count, &r->mark_room, OBJ_MARKS_MAX, sizeof *marks,
                             key, "marked edges and points");
  if (marks == NULL) return 0;
  m->marks = marks;
  const obj_mark mark = {{a, b}, key->line};
  marks[m->mark_count++] = mark;
  return 1;
}

static int read_marks(reader *r, const word *key, int is_line) {
  uint32_t before = OBJ_NONE;
  uint32_t count = 0;
  word w = next_word(r);
  for (; w.bytes != 0; w = next_word(r), ++count) {
    uint32_t point = 0;
    if (!read_corner(r, &w, &point)) return 0;
    if (is_line && point == before) return fail(r, &w, "another point than the one before");
    if (!is_line && !add_mark(r, key, point, point)) return 0;
    if (is_line && before != OBJ_NONE && !add_mark(r, key, before, point)) return 0;
    before = point;
  }
  if (count < (is_line ? 2u : 1u)) return fail(r, &w, is_line ? "2 points for 'l'" : "a point for 'p'");
  return 1;
}

static int is_skipped(const word *w) {
  static const char *const keys[] = {"vt", "vn", "vp", "o", "g", "s", "mg", "usemtl", "mtllib"};
  for (size_t n = 0; n < sizeof keys / sizeof keys[0]; ++n)
    if (word_is(w, keys[n])) return 1;
  return 0;
}

static int read_line(reader *r) {
  r->ended = 0;
  const word key = next_word(r);
  int good = 1;
  if (word_is(&key, "v"))
    good = read_point(r, &key);
  else if (word_is(&key, "f"))
    good = read_face(r, &key);
  else if (word_is(&key, "l") || word_is(&key, "p"))
    good = read_marks(r, &key, key.text[0] == 'l');
  else if (is_skipped(&key))
    while (next_word(r).bytes != 0) continue;
  else if (key.bytes != 0)
    good = fail(r, &key, "v, f, l, p, or keys that are skipped: vt, vn, vp, o, g, s, mg, usemtl, mtllib");
  if (good) new_line(r);
  return good;
}

int obj_read(const char *file, const char *text, size_t bytes, obj_mesh *mesh, scene_error *error) {
  reader r;
  memset(&r, 0, sizeof r);
  memset(mesh, 0, sizeof *mesh);
  r.file = file;
  r.text = text;
  r.bytes = bytes;
  r.line = 1;
  r.mesh = mesh;
  r.error = error;
  if (bytes > OBJ_BYTES_MAX)
    return obj_refuse(error, file, 0, 0, "found more than %d bytes, expected an OBJ file",
                      OBJ_BYTES_MAX);
  while (r.at < r.bytes)
    if (!read_line(&r)) return 0;
  if (mesh->triangle_count == 0)
    return obj_refuse(error, file, 0, 0, "has no faces, expected lines 'v x y z' and 'f a b c'");
  return obj_join(file, mesh, error);
}

int obj_load(const char *file, obj_mesh *mesh, scene_error *error) {
  char why[INPUT_FILE_WHY];
  size_t bytes = 0;
  memset(mesh, 0, sizeof *mesh);
  uint8_t *text = input_file_read(file, OBJ_BYTES_MAX, &bytes, why);
  if (text == NULL) return obj_refuse(error, file, 0, 0, "%s", why);
  const int good = obj_read(file, (const char *)text, bytes, mesh, error);
  free(text);
  return good;
}

void obj_free(obj_mesh *mesh) {
  free(mesh->points);
  free(mesh->triangles);
  free(mesh->marks);
  free(mesh->edges);
  memset(mesh, 0, sizeof *mesh);
}
