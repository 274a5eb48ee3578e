/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes and scripts: any text is refused with a place and a message, or is a scene; a small one
 * with fixed substeps compiles or is refused, and its image opens and runs. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "tools/build/build.h"
#include "tools/script.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

static void run_image(const uint8_t *image, size_t bytes) {
  size_t needed = 0;
  fray_world *world = NULL;
  fray_output output;
  const fray_input input = {3, {{100, 200, 300, 1, 0}, {-1, 1, 3, 1, 15}}, FRAY_VERB_START, 1};
  if (fray_bytes(image, bytes, &needed, NULL) != FRAY_OK) abort();
  needed = (needed + FRAY_ALIGN - 1) / FRAY_ALIGN * FRAY_ALIGN;
  void *memory = aligned_alloc(FRAY_ALIGN, needed);
  if (memory == NULL) return;
  /* the compiler must not make what the loader refuses */
  if (fray_open(image, bytes, memory, needed, &world, NULL) != FRAY_OK) abort();
  for (int n = 0; n < 3; ++n) fray_tick(world, &input, &output);
  free(memory);
}

static void compile(scene *s) {
  scene_error error;
  build_report report;
  uint8_t *image = NULL;
  size_t bytes = 0;
  memset(&error, 0, sizeof error);
  if (s->sheet.warps * s->sheet.wefts > 400 || s->substeps == 0 || s->substeps > 32 ||
      s->sweeps == 0 || s->sweeps > 8 || s->limits.contacts > 10000)
    return;
  s->settle.numerator = 0; /* coming to rest is only slow */
  if (build_image(s, "fuzz.scene", &image, &bytes, &report, NULL, NULL, &error)) {
    run_image(image, bytes);
    free(image);
  } else if (error.message[0] == 0) {
    abort();
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes) {
  static scene parsed;
  static script read;
  scene_error error;
  candump_error script_error;
  memset(&error, 0, sizeof error);
  memset(&script_error, 0, sizeof script_error);
  char *text = malloc(bytes + (bytes == 0));
  if (text == NULL) return 0;
  if (bytes != 0) memcpy(text, data, bytes);
  if (scene_parse("fuzz.scene", text, bytes, &parsed, &error))
    compile(&parsed);
  else if (error.message[0] == 0)
    abort();
  if (!script_parse("fuzz.hand", text, bytes, &read, &script_error) && script_error.message[0] == 0)
    abort();
  free(text);
  return 0;
}
