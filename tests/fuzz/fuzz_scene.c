/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes and scripts: any text is refused with a place and a message, or is a scene; a small one
 * with fixed substeps compiles or is refused, and its image opens and runs. */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "tests/fuzz/run_image.h"
#include "tools/scene_compiler/compile.h"
#include "tools/bus/script.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes);

enum { COMPILED_TICKS = 20 };

static void compile(scene *s) {
  scene_error error = {0};
  compile_report report;
  uint8_t *image = NULL;
  size_t bytes = 0;
  if (s->woven.warps * s->woven.wefts > 400 || s->substeps == 0 || s->substeps > 32 ||
      s->iterations == 0 || s->iterations > 8 || s->limits.contacts > 10000)
    return;
  s->settle.numerator = 0; /* coming to rest is only slow */
  if (compile_image(s, "fuzz.scene", &image, &bytes, &report, NULL, NULL, &error)) {
    run_image(image, bytes, COMPILED_TICKS);
  } else if (error.message[0] == 0) {
    abort();
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t bytes) {
  static scene parsed;
  static script read;
  scene_error error = {0};
  candump_error script_error = {0};
  char *text = malloc(bytes + (bytes == 0));
  if (text == NULL) return 0;
  run_count();
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
