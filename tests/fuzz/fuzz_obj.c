/* SPDX-License-Identifier: Apache-2.0 */
/* OBJ files: any bytes are refused with a message, or are a manifold; as the mesh of a scene it
 * compiles or is refused with the file's name, and its image opens and runs. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/run_image.h"
#include "tools/scene_compiler/compile.h"
#include "tools/mesh_import/obj.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

enum { COMPILED_TICKS = 20 };

static const char form[] =
    "scene f\nsubsteps 1\nwoven { warps 5 wefts 5 spacing 12 /cm orientation horizontal at 0 0.6 0 cm }\n"
    "mesh m { obj case.obj at 0 0 0 cm sharp 60 deg move free mass 5 g velocity 0 500 0 cm/s }\n"
    "mesh n { obj case.obj at 0 -3 0 cm sharp %s rotate 20 deg about x }\nplane p { at 0 -9 0 cm }\n";

static void compile(const uint8_t *data, size_t bytes, int has_marks) {
  static scene parsed;
  const char *room = getenv("FRAY_FUZZ_CASE"); /* a folder of this process alone */
  char path[512];
  char text[sizeof form + 8];
  scene_error error = {0};
  compile_report report;
  uint8_t *image = NULL;
  size_t image_bytes = 0;
  snprintf(path, sizeof path, "%s/case.obj", room != NULL ? room : ".");
  FILE *out = fopen(path, "wb");
  if (out == NULL) abort();
  if (fwrite(data, 1, bytes, out) != bytes) abort();
  fclose(out);
  snprintf(path, sizeof path, "%s/case.scene", room != NULL ? room : ".");
  snprintf(text, sizeof text, form, has_marks ? "named" : "off");
  if (!scene_parse(path, text, strlen(text), &parsed, &error)) abort();
  if (compile_image(&parsed, path, &image, &image_bytes, &report, NULL, NULL, &error)) {
    run_image(image, image_bytes, COMPILED_TICKS);
  } else if (error.message[0] == 0) {
    abort();
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes) {
  obj_mesh mesh;
  scene_error error = {0};
  char *copy = malloc(bytes + (bytes == 0));
  if (copy == NULL) return 0;
  run_count();
  if (bytes != 0) memcpy(copy, data, bytes);
  if (obj_read("fuzz.obj", copy, bytes, &mesh, &error)) {
    if (mesh.triangle_count < 400) compile(data, bytes, mesh.mark_count > 0);
  } else if (error.message[0] == 0) {
    abort();
  }
  obj_free(&mesh);
  free(copy);
  return 0;
}
