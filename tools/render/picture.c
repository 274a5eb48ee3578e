/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/picture.h"

#include <errno.h>
#include <stdio.h>

#include "tools/render/body_picture.h"
#include "tools/render/font.h"
#include "tools/render/lighting.h"
#include "tools/render/membrane_picture.h"
#include "tools/render/yarn_cloth_picture.h"
#include "tools/render/wire_picture.h"

enum { MAP_SIDE = 1536, SAMPLES = 2 };

picture_style picture_style_default(bounds frame, cloth_look look) {
  const int wire = look == LOOK_WIRE;
  return (picture_style){.cloth = cloth_style_default(look),
                         .top = rgb_hex(wire ? 0xFFFFFF : 0xEEF0F2),
                         .bottom = rgb_hex(wire ? 0xFFFFFF : 0xC9CDD2),
                         .frame = frame,
                         .ground = !wire};
}

static float diagonal(bounds b) {
  const float d = v3_length(v3_sub(b.high, b.low));
  return isfinite(d) && d > 1.0f ? d : 1.0f;
}

static void draw_ground(canvas *c, const camera *cam, const lighting *light,
                        const picture_source *source, const picture_style *style) {
  const bounds b = style->frame;
  const float size = diagonal(b);
  int planes = 0;
  v3 centre = v3_scale(v3_add(b.low, b.high), 0.5f);
  for (uint32_t k = 0; k < source->body_count; k++) {
    const picture_body *body = source->bodies + k;
    if (body->shape != FRAY_PLANE) continue;
    planes++;
    const v3 n = v3_unit(body->axes[1]);
    const v3 at = v3_add_scaled(centre, n, v3_dot(v3_sub(body->position, centre), n));
    body_picture_draw_ground(c, cam, light, at, n, 1.6f * size, 10.0f);
  }
  if (planes) return;
  centre.y = b.low.y - 0.03f * size;
  body_picture_draw_ground(c, cam, light, centre, (v3){0, 1, 0}, 1.1f * size, 0.0f);
}

static void draw_strain_key(canvas *c, const char *max) {
  const float unit = fmaxf(1.0f, roundf((float)c->width / 640.0f));
  const float width = 150.0f * unit, height = 6.0f * unit,
              x = (float)c->width - width - 14.0f * unit;
  const float y = (float)c->height - 30.0f * unit;
  const rgb ink = rgb_hex(0x3A4048);
  for (int k = 0; k < 64; k++) {
    const float s = (float)k / 64.0f, e = (float)(k + 1) / 64.0f;
    canvas_box(c, x + s * width, y, x + e * width, y + height,
               cloth_strain_colour(2.0f * (s + 1.0f / 128.0f) - 1.0f), 1.0f);
  }
  font_draw(c, x, y + 9.0f * unit, unit, "slack", ink, FONT_LEFT);
  font_draw(c, x + 0.5f * width, y + 9.0f * unit, unit, "rest", ink, FONT_CENTRE);
  font_draw(c, x + width, y + 9.0f * unit, unit, max, ink, FONT_RIGHT);
}

static int tears(const picture_source *source) {
  for (uint32_t t = 0; t < source->triangle_count; t++)
    if (source->triangles[t].strength > 0.0f) return 1;
  return 0;
}

static void draw_text(canvas *c, const picture_source *source, const picture_style *style) {
  char max[32] = "tears";
  const float unit = fmaxf(1.0f, roundf((float)c->width / 640.0f));
  if (source->triangle_count && !tears(source)) snprintf(max, sizeof max, "%g N/m", (double)style->cloth.stress_full);
  if (style->cloth.strain) draw_strain_key(c, max);
  if (!style->caption) return;
  /* A light rim: the caption may stand before cloth. */
  for (int n = 0; n < 5; n++) {
    static const float rim[5][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {0, 0}};
    font_draw(c, (14.0f + rim[n][0]) * unit, (float)c->height + (rim[n][1] - 21.0f) * unit, unit,
              style->caption, n < 4 ? style->bottom : rgb_hex(0x3A4048), FONT_LEFT);
  }
}

static int draw_cloth(canvas *c, const camera *cam, const lighting *light,
                      const picture_source *source, const cloth_style *style) {
  if (source->triangle_count) return membrane_picture_draw(c, cam, light, source, style);
  switch (style->look) {
    case LOOK_SURFACE: return woven_picture_draw(c, cam, light, source, style);
    case LOOK_YARN: return yarn_cloth_picture_draw(c, cam, light, source, style);
    case LOOK_WIRE: break;
  }
  if (light) wire_picture_draw(c, cam, source, style); /* wires cast no shadow */
  return 1;
}

int picture_draw(canvas *c, const camera *cam, const picture_source *source,
                 const picture_style *style) {
  lighting light;
  bounds over = picture_source_bounds(source);
  bounds_join(&over, style->frame);
  const float texels = 2.0f * diagonal(over) / (0.98f * MAP_SIDE);
  if (!lighting_open(&light, over, fmaxf(0.7f * source->spacing, texels), MAP_SIDE)) return 0;
  int good = draw_cloth(&light.map, &light.sun, NULL, source, &style->cloth);
  for (uint32_t k = 0; k < source->body_count; k++)
    body_picture_draw(&light.map, &light.sun, NULL, source->bodies + k);

  canvas_fill(c, style->top, style->bottom);
  if (style->ground) draw_ground(c, cam, &light, source, style);
  for (uint32_t k = 0; k < source->body_count; k++)
    body_picture_draw(c, cam, &light, source->bodies + k);
  body_picture_draw_pins(c, cam, &light, source);
  good = draw_cloth(c, cam, &light, source, &style->cloth) && good;
  draw_text(c, source, style);
  lighting_close(&light);
  return good;
}

int picture_draw_world(canvas *c, const camera *cam, const fray_world *world,
                  const picture_style *style) {
  picture_source source = {0};
  const int good = picture_source_read(&source, world) && picture_draw(c, cam, &source, style);
  picture_source_close(&source);
  return good;
}

bounds picture_bounds(const fray_world *world) {
  picture_source source = {0};
  bounds b = bounds_none();
  if (picture_source_read(&source, world)) b = picture_source_bounds(&source);
  picture_source_close(&source);
  return b;
}

int picture_write(const fray_world *world, const camera *cam, const picture_style *style,
                  uint32_t width, uint32_t height, const char *path) {
  canvas c;
  if (!canvas_open(&c, width, height, SAMPLES)) {
    errno = ENOMEM;
    return 0;
  }
  errno = ENOMEM;
  const int good = picture_draw_world(&c, cam, world, style) && canvas_write(&c, path);
  canvas_close(&c);
  return good;
}
