/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/woven_sample.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int compile(const char *name, const char *text, int bytes, session *s) {
  scene_error error;
  compile_report report;
  memset(s, 0, sizeof *s);
  scene *parsed = malloc(sizeof *parsed);
  const int good = parsed != NULL && scene_parse(name, text, (size_t)bytes, parsed, &error) &&
                   compile_image(parsed, name, &s->world_file.image, &s->world_file.image_bytes, &report,
                               NULL, NULL, &error) &&
                   world_file_open_image(name, &s->world_file, stderr) == 0;
  free(parsed);
  if (good)
    s->facts = fray_get_info(s->world_file.world);
  else
    world_file_close(&s->world_file);
  return good;
}

int woven_sample_open(uint32_t warps, uint32_t wefts, session *s) {
  char text[512];
  char name[32];
  snprintf(name, sizeof name, "%ux%u", warps, wefts);
  const int bytes = snprintf(text, sizeof text,
                             "scene bench\nrate 1000 Hz\nsubsteps %d\niterations 1\n"
                             "woven {\n warps %u\n wefts %u\n spacing 12 /cm\n gather 5 %%\n"
                             " tear off\n}\npin row top\n",
                             WOVEN_SAMPLE_SUBSTEPS, warps, wefts);
  return compile(name, text, bytes, s);
}

/* By their width: the balls go out by a fifth at each side, the bars by an eighth. What fits in a tick
 * grows with the sheet, so that sheets of all sizes tear alike. */
int woven_sample_open_torn(uint32_t warps, uint32_t wefts, woven_sample_bodies bodies, const char *yarns, session *s) {
  char text[1024];
  char name[32];
  const double x = (warps - 1) / 24.0;
  const double y = (wefts - 1) / 24.0;
  const double seconds = WOVEN_SAMPLE_TORN_TICKS / 1000.0;
  snprintf(name, sizeof name, "%ux%u", warps, wefts);
  int bytes = snprintf(text, sizeof text,
                       "scene bench\nrate 1000 Hz\nsubsteps %d\niterations 1\ngravity 0 0 0 cm/s2\nseed 6\n"
                       "limits {\n splits_per_tick %u\n tears_per_tick %u\n}\n"
                       "woven {\n warps %u\n wefts %u\n spacing 12 /cm\n tear 5 10 %%\n yarns %s\n"
                       " slip_friction 0.3\n crossing_friction 0.3 mN\n drag 20 /s\n}\n",
                       WOVEN_SAMPLE_TORN_SUBSTEPS, warps * wefts / 100, warps * wefts / 800 + 1, warps, wefts,
                       yarns);
  for (int side = -1; side <= 1; side += 2) {
    const char *const label = side < 0 ? "left" : "right";
    char *const to = text + bytes;
    const size_t room = sizeof text - (size_t)bytes;
    bytes += bodies == WOVEN_SAMPLE_SPHERES
                 ? snprintf(to, room,
                            "sphere %s {\n radius %.3f cm\n attach_within 0 cm\n"
                            " move path { 0 s %.4f %.4f 0 cm %.3f s %.4f %.4f 0 cm }\n}\n",
                            label, y * 2 / 7, side * x, y, seconds, side * x * 1.2, y)
                 : snprintf(to, room,
                            "capsule %s {\n radius 0.05 cm\n length %.3f cm\n rotate 90 deg about z\n"
                            " attach_within 0.01 cm\n move path { 0 s %.4f 0 0 cm %.3f s %.4f 0 0 cm }\n}\n",
                            label, y * 2, side * x, seconds, side * x * 1.125);
  }
  return compile(name, text, bytes, s);
}
