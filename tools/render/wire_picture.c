/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/wire_picture.h"

#include "tools/render/yarn_axes.h"

static v3 wire_point(const picture_source *s, int axis, uint32_t crossing) {
  return v3_add_scaled(s->crossings[crossing], s->half_gap[crossing], axis == AXIS_WARP ? 1.0f : -1.0f);
}

static void draw_wire(canvas *c, const camera *cam, const picture_source *s, v3 from, v3 to,
                      rgb colour) {
  canvas_vertex a, b;
  if (!camera_project(cam, from, &a) || !camera_project(cam, to, &b)) return;
  const float pixels = s->spacing * camera_pixels(cam, from);
  const float width = fminf(1.8f, fmaxf(0.9f, 0.2f * pixels));
  canvas_wire(c, &a, &b, width, colour, 0.9f);
}

/* The base first, so that no yarn is lost below it. */
void wire_picture_draw(canvas *c, const camera *cam, const picture_source *source,
                       const cloth_style *style) {
  const yarn_axes axes = {.source = source};
  for (int split = 0; split < 2; split++) {
    for (int axis = 0; axis < AXES; axis++) {
      for (uint32_t n = 0; n < yarn_paths(source, axis); n++) {
        const yarn_path path = yarn_path_of(&axes, axis, n);
        for (uint32_t k = 0; k + 1 < path.count; k++) {
          const uint32_t a = yarn_path_crossing(&path, k), b = yarn_path_crossing(&path, k + 1);
          if (!yarn_path_joined(&path, k) || (source->split[a] || source->split[b]) != split)
            continue;
          draw_wire(c, cam, source, wire_point(source, axis, a), wire_point(source, axis, b),
                    split ? style->split : style->base);
        }
      }
    }
  }
}
