/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/sheets.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int sheet_open(uint32_t warps, uint32_t wefts, session *s) {
  char text[512];
  char name[32];
  scene_error error;
  build_report report;
  snprintf(name, sizeof name, "%ux%u", warps, wefts);
  const int bytes = snprintf(text, sizeof text,
                             "scene bench\nrate 1000 Hz\nsubsteps %d\nsweeps 1\n"
                             "sheet {\n warps %u\n wefts %u\n spacing 12 /cm\n gather 5 %%\n"
                             " tear off\n}\npin row top\n",
                             SHEET_SUBSTEPS, warps, wefts);
  memset(s, 0, sizeof *s);
  scene *parsed = malloc(sizeof *parsed);
  const int good = parsed != NULL && scene_parse(name, text, (size_t)bytes, parsed, &error) &&
                   build_image(parsed, name, &s->opened.image, &s->opened.image_bytes, &report,
                               NULL, NULL, &error) &&
                   world_open_image(name, &s->opened, stderr) == 0;
  free(parsed);
  if (good)
    s->facts = fray_describe(s->opened.world);
  else
    world_close(&s->opened);
  return good;
}
