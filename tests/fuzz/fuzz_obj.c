/* SPDX-License-Identifier: Apache-2.0 */
/* OBJ files: any bytes are refused with a message, or are a manifold; as the mesh of a scene it
 * compiles or is refused with the file's name, and its image opens and runs. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tools/build/build.h"
#include "tools/build/obj.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

static const char text[] =
    "scene f\nsubsteps 1\nsheet { warps 5 wefts 5 spacing 12 /cm plane horizontal at 0 0.6 0 cm }\n"
    "mesh m { obj case.obj at 0 0 0 cm sharp 60 deg move free mass 5 g velocity 0 500 0 cm/s }\n"
    "mesh n { obj case.obj at 0 -3 0 cm sharp named turn 20 deg about x }\nplane p { at 0 -9 0 cm }\n";

static void run_image(const uint8_t *image, size_t bytes) {
  size_t needed = 0;
  fray_world *world = NULL;
  fray_output output;
  const fray_input input = {0};
  if (fray_bytes(image, bytes, &needed, NULL) != FRAY_OK) abort();
  needed = (needed + FRAY_ALIGN - 1) / FRAY_ALIGN * FRAY_ALIGN;
  void *memory = aligned_alloc(FRAY_ALIGN, needed);
  if (memory == NULL) return;
  if (fray_open(image, bytes, memory, needed, &world, NULL) != FRAY_OK) abort();
  for (int n = 0; n < 3; ++n) fray_tick(world, &input, &output);
  free(memory);
}

static void compile(const uint8_t *data, size_t bytes) {
  static scene parsed;
  const char *build = getenv("FRAY_BUILD");
  char path[512];
  scene_error error;
  build_report report;
  uint8_t *image = NULL;
  size_t image_bytes = 0;
  snprintf(path, sizeof path, "%s/fuzz/case.obj", build != NULL ? build : "build");
  FILE *out = fopen(path, "wb");
  if (out == NULL) abort();
  if (fwrite(data, 1, bytes, out) != bytes) abort();
  fclose(out);
  snprintf(path, sizeof path, "%s/fuzz/case.scene", build != NULL ? build : "build");
  memset(&error, 0, sizeof error);
  if (!scene_parse(path, text, sizeof text - 1, &parsed, &error)) abort();
  if (build_image(&parsed, path, &image, &image_bytes, &report, NULL, NULL, &error)) {
    run_image(image, image_bytes);
    free(image);
  } else if (error.message[0] == 0) {
    abort();
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes) {
  obj_mesh mesh;
  scene_error error;
  memset(&error, 0, sizeof error);
  char *copy = malloc(bytes + (bytes == 0));
  if (copy == NULL) return 0;
  if (bytes != 0) memcpy(copy, data, bytes);
  if (obj_read("fuzz.obj", copy, bytes, &mesh, &error)) {
    if (mesh.triangle_count < 400) compile(data, bytes);
  } else if (error.message[0] == 0) {
    abort();
  }
  obj_free(&mesh);
  free(copy);
  return 0;
}
