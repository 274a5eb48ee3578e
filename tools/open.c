/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/open.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "platform/linux/cpu.h"
#include "tools/progress.h"

enum { OPEN_FAILED = 2 };

static uint8_t *read_stream(FILE *in, size_t *bytes) {
  size_t room = 1 << 16;
  uint8_t *data = malloc(room);
  *bytes = 0;
  while (data != NULL) {
    *bytes += fread(data + *bytes, 1, room - 1 - *bytes, in);
    if (*bytes < room - 1) break;
    uint8_t *grown = room > SIZE_MAX / 2 ? NULL : realloc(data, room * 2);
    if (grown == NULL) free(data);
    data = grown;
    room *= 2;
  }
  if (data != NULL && ferror(in)) {
    free(data);
    data = NULL;
  }
  if (data != NULL) data[*bytes] = 0;
  return data;
}

uint8_t *world_read_file(const char *path, size_t *bytes, FILE *err) {
  FILE *in = fopen(path, "rb");
  if (in == NULL) {
    fprintf(err, "%s: cannot be opened: %s\n", path, strerror(errno));
    return NULL;
  }
  uint8_t *data = read_stream(in, bytes);
  fclose(in);
  if (data == NULL) fprintf(err, "%s: cannot be read, expected a scene or an image\n", path);
  return data;
}

static void print_scene_error(FILE *err, const char *path, const scene_error *e) {
  fprintf(err, "%s:", e->file[0] != 0 ? e->file : path);
  if (e->line > 0) fprintf(err, "%d:", e->line);
  if (e->column > 0) fprintf(err, "%d:", e->column);
  fprintf(err, " %s\n", e->message);
}

static void show_test_run(void *context, uint32_t substeps, uint32_t sweeps, uint32_t tick,
                          uint32_t ticks) {
  char what[64];
  (void)context;
  snprintf(what, sizeof what, "test run with %u substeps, %u sweeps", substeps, sweeps);
  progress_show(what, tick, ticks);
}

static uint8_t *compile(const char *path, const char *text, size_t text_bytes, size_t *bytes,
                        build_report *report, FILE *err) {
  scene_error error;
  uint8_t *image = NULL;
  memset(&error, 0, sizeof error);
  scene *s = malloc(sizeof *s);
  const int good = s != NULL && scene_parse(path, text, text_bytes, s, &error) &&
                   build_image(s, path, &image, bytes, report, show_test_run, NULL, &error);
  progress_end();
  if (s == NULL) fprintf(err, "%s: not enough memory to compile it\n", path);
  if (s != NULL && !good) print_scene_error(err, path, &error);
  free(s);
  return image;
}

uint8_t *world_compile_file(const char *path, size_t *bytes, build_report *report, FILE *err) {
  size_t text_bytes = 0;
  uint8_t *text = world_read_file(path, &text_bytes, err);
  if (text == NULL) return NULL;
  uint8_t *image = compile(path, (const char *)text, text_bytes, bytes, report, err);
  free(text);
  return image;
}

static const char *status_text(fray_status status) {
  switch (status) {
    case FRAY_OK: return "no error";
    case FRAY_BAD_ARGUMENT: return "bad argument";
    case FRAY_TRUNCATED: return "the image is cut off";
    case FRAY_BAD_MAGIC: return "this is not an image";
    case FRAY_BAD_VERSION: return "another version of the image format";
    case FRAY_BAD_CRC: return "the image is damaged (CRC)";
    case FRAY_BAD_SECTION: return "a bad section";
    case FRAY_BAD_FIELD: return "a bad field";
    case FRAY_BAD_BATCH: return "a bad batch";
    case FRAY_SMALL_MEMORY: return "not enough memory";
  }
  return "unknown error";
}

static int fail_image(const char *path, fray_status status, const fray_error *error, FILE *err) {
  fprintf(err, "%s: %s, section %lu, element %lu: expected %s\n", path, status_text(status),
          (unsigned long)error->section, (unsigned long)error->index,
          error->what != NULL ? error->what : "a valid image");
  return OPEN_FAILED;
}

int world_open_image(const char *path, struct opened *o, FILE *err) {
  fray_error error = {FRAY_OK, 0, 0, NULL};
  fray_status status = fray_bytes(o->image, o->image_bytes, &o->memory_bytes, &error);
  if (status != FRAY_OK) return fail_image(path, status, &error, err);
  const size_t align = FRAY_ALIGN;
  o->memory_bytes = (o->memory_bytes + align - 1) / align * align;
  o->memory = aligned_alloc(align, o->memory_bytes);
  if (o->memory == NULL) {
    fprintf(err, "%s: not enough memory, it needs %lu bytes\n", path,
            (unsigned long)o->memory_bytes);
    return OPEN_FAILED;
  }
  status = fray_open(o->image, o->image_bytes, o->memory, o->memory_bytes, &o->world, &error);
  if (status != FRAY_OK) return fail_image(path, status, &error, err);
  cpu_use_best(o->world);
  return 0;
}

int world_open_file(const char *path, struct opened *out, FILE *err) {
  memset(out, 0, sizeof *out);
  out->image = world_read_file(path, &out->image_bytes, err);
  if (out->image == NULL) return OPEN_FAILED;
  if (out->image_bytes == 0) {
    fprintf(err, "%s: is empty, expected a scene or an image\n", path);
    world_close(out);
    return OPEN_FAILED;
  }
  if (out->image_bytes < 4 || memcmp(out->image, "FRAY", 4) != 0) {
    build_report report;
    uint8_t *text = out->image;
    out->image = compile(path, (const char *)text, out->image_bytes, &out->image_bytes, &report, err);
    free(text);
    if (out->image == NULL) return OPEN_FAILED;
  }
  const int code = world_open_image(path, out, err);
  if (code != 0) world_close(out);
  return code;
}

void world_close(struct opened *o) {
  free(o->memory);
  free(o->image);
  memset(o, 0, sizeof *o);
}
