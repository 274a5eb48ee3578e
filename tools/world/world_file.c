/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/world/world_file.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "platform/files/input_file.h"
#include "platform/linux/cpu.h"
#include "tools/terminal/progress.h"

enum { OPEN_FAILED = 2 };

uint8_t *world_file_read(const char *path, uint64_t most, size_t *bytes, FILE *err) {
  char why[INPUT_FILE_WHY];
  uint8_t *data = input_file_read(path, most, bytes, why);
  if (data == NULL) fprintf(err, "%s: %s\n", path, why);
  return data;
}

static void print_scene_error(FILE *err, const char *path, const scene_error *e) {
  fprintf(err, "%s:", e->file[0] != 0 ? e->file : path);
  if (e->line > 0) fprintf(err, "%d:", e->line);
  if (e->column > 0) fprintf(err, "%d:", e->column);
  fprintf(err, " %s\n", e->message);
}

static void print_notes(FILE *err, const char *path, const scene *s) {
  for (uint32_t n = 0; n < s->note_count; ++n)
    fprintf(err, "%s:%d:%d: note: %s\n", path, s->notes[n].place.line, s->notes[n].place.column,
            s->notes[n].text);
}

static void show_test_run(void *context, uint32_t substeps, uint32_t iterations, uint32_t tick,
                          uint32_t ticks) {
  char what[64];
  (void)context;
  snprintf(what, sizeof what, "test run with %u substeps, %u iterations", substeps, iterations);
  progress_show(what, tick, ticks);
}

static int is_image(const uint8_t *data, size_t bytes) { return bytes >= 4 && memcmp(data, "FRAY", 4) == 0; }

/* The strain at rest is measured where the report is wanted. */
static uint8_t *compile(const char *path, const char *text, size_t text_bytes, size_t *bytes,
                        compile_report *wanted, FILE *err) {
  compile_report own;
  compile_report *report = wanted != NULL ? wanted : &own;
  scene_error error;
  uint8_t *image = NULL;
  if (memchr(text, 0, text_bytes) != NULL) {
    fprintf(err, "%s: is neither an image, which begins with FRAY, nor a scene, which is a text\n", path);
    return NULL;
  }
  memset(&error, 0, sizeof error);
  scene *s = malloc(sizeof *s);
  int good = s != NULL && scene_parse(path, text, text_bytes, s, &error) &&
             compile_image(s, path, &image, bytes, report, show_test_run, NULL, &error);
  if (good && wanted != NULL && !report->searched && !s->membrane.present)
    good = compile_rest_strain(s, path, report, show_test_run, NULL, &error);
  progress_end();
  if (!good) {
    free(image);
    image = NULL;
  }
  if (good) print_notes(err, path, s);
  if (s == NULL) fprintf(err, "%s: not enough memory to compile it\n", path);
  if (s != NULL && !good) print_scene_error(err, path, &error);
  free(s);
  return image;
}

uint8_t *world_file_compile(const char *path, size_t *bytes, compile_report *report, FILE *err) {
  size_t text_bytes = 0;
  uint8_t *text = world_file_read(path, INPUT_FILE_SCRIPT_MAX, &text_bytes, err);
  if (text == NULL) return NULL;
  if (is_image(text, text_bytes)) fprintf(err, "%s: is an image, expected a scene\n", path);
  uint8_t *image = is_image(text, text_bytes) ? NULL : compile(path, (const char *)text, text_bytes, bytes, report, err);
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

/* What follows may differ from what the other build would compute. */
static void note_physics(const char *path, const fray_world *w, FILE *err) {
  const uint32_t id = fray_get_info(w).physics_id, own = fray_physics_id();
  if (id == own) return;
  fprintf(err, "%s: made by another version of the physics (id %08" PRIx32 ", this build has %08" PRIx32 ")\n",
          path, id, own);
}

int world_file_open_image(const char *path, struct world_file *o, FILE *err) {
  fray_error error = {FRAY_OK, 0, 0, NULL};
  fray_status status = fray_memory_size(o->image, o->image_bytes, &o->memory_bytes, &error);
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
  note_physics(path, o->world, err);
  const size_t used = fray_save_bytes(o->world);
  if (used < o->image_bytes)
    fprintf(err, "%s: note: the image ends after %zu bytes, %zu behind it are not read\n", path, used,
            o->image_bytes - used);
  cpu_use_best(o->world);
  return 0;
}

int world_file_open(const char *path, struct world_file *out, FILE *err) {
  memset(out, 0, sizeof *out);
  out->image = world_file_read(path, INPUT_FILE_WORLD_MAX, &out->image_bytes, err);
  if (out->image == NULL) return OPEN_FAILED;
  if (out->image_bytes == 0) {
    fprintf(err, "%s: is empty, expected a scene or an image\n", path);
    world_file_close(out);
    return OPEN_FAILED;
  }
  if (!is_image(out->image, out->image_bytes)) {
    uint8_t *text = out->image;
    out->image = compile(path, (const char *)text, out->image_bytes, &out->image_bytes, NULL, err);
    free(text);
    if (out->image == NULL) return OPEN_FAILED;
  }
  const int code = world_file_open_image(path, out, err);
  if (code != 0) world_file_close(out);
  return code;
}

void world_file_close(struct world_file *o) {
  free(o->memory);
  free(o->image);
  memset(o, 0, sizeof *o);
}
