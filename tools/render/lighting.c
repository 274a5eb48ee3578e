/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/lighting.h"

int lighting_open(lighting *l, bounds over, float reach_mm, uint32_t map_side) {
  l->key = v3_unit((v3){-0.55f, 0.85f, 0.62f});
  l->fill = v3_unit((v3){0.80f, 0.15f, 0.60f});
  l->reach = reach_mm;
  l->sun = camera_light(over, l->key, map_side);
  return canvas_open(&l->map, map_side, map_side, 1);
}

void lighting_close(lighting *l) { canvas_close(&l->map); }

/* Nine bilinear taps of equal weight make a 4x4 tent: no steps, and no noise to compress. */
float lighting_visibility(const lighting *l, v3 at, v3 normal) {
  canvas_vertex v;
  const v3 lifted = v3_add_scaled(v3_add_scaled(at, normal, l->reach), l->key, 0.6f * l->reach);
  if (!camera_project(&l->sun, lifted, &v)) return 1.0f;
  const float x = v.x - 0.5f, y = v.y - 0.5f;
  const int column = (int)floorf(x), row = (int)floorf(y);
  const float fx = x - (float)column, fy = y - (float)row;
  const canvas *map = &l->map;
  if (column < 1 || row < 1 || column + 2 >= (int)map->columns || row + 2 >= (int)map->rows) {
    return 1.0f;
  }
  const float wy[4] = {1.0f - fy, 1.0f, 1.0f, fy};
  const float *depth = map->depth + (size_t)(row - 1) * map->columns + (size_t)(column - 1);
  float sum = 0.0f;
  for (int j = 0; j < 4; j++, depth += map->columns) {
    sum += wy[j] * ((depth[0] <= v.depth ? 1.0f - fx : 0.0f) + (depth[1] <= v.depth ? 1.0f : 0.0f) +
                    (depth[2] <= v.depth ? 1.0f : 0.0f) + (depth[3] <= v.depth ? fx : 0.0f));
  }
  return sum / 9.0f;
}

/* To the 32nd. */
static float sharpened(float shine) {
  for (int k = 0; k < 5; k++) shine *= shine;
  return shine;
}

/* `normal` carries the texture, `smooth` the shape: the terminator and the shadow follow the
 * shape, so that yarns do not sparkle where the light grazes. Both face the viewer. */
rgb lighting_shade(const lighting *l, const surface_material *m, v3 at, v3 normal, v3 smooth, v3 towards) {
  const float facing = v3_dot(smooth, l->key);
  /* What faces away asks no map: there the answer would only be noise. */
  const float grazing = clamp01(facing * 4.0f);
  const float open = grazing > 0.0f ? grazing * lighting_visibility(l, at, smooth) : 0.0f;
  const float bump = clamp01(v3_dot(normal, l->key) * 0.9f + 0.1f);
  const float direct = bump * open;
  const float behind = m->through * clamp01(-facing);
  const float fill = clamp01(v3_dot(normal, l->fill) * 0.8f + 0.2f);
  const float sky = 0.5f + 0.5f * normal.y;
  const float rim = 1.0f - clamp01(v3_dot(smooth, towards));
  const float sheen = m->sheen * rim * rim * rim * (0.3f + 0.7f * open);
  const v3 half = v3_unit(v3_add(l->key, towards));
  const float shine = clamp01(v3_dot(normal, half));
  const float gloss = m->gloss > 0.0f ? m->gloss * sharpened(shine) * open : 0.0f;
  const float occluded = 0.80f + 0.20f * open;
  const rgb warm = {1.02f, 0.98f, 0.90f}, cool = {0.80f, 0.92f, 1.08f};
  const float a = 0.82f * (direct + behind), b = (0.22f * fill + 0.20f * sky + 0.09f) * occluded;
  const float d = sheen * 0.35f + gloss;
  return (rgb){m->colour.r * (a * warm.r + b * cool.r) + d,
               m->colour.g * (a * warm.g + b * cool.g) + d,
               m->colour.b * (a * warm.b + b * cool.b) + d};
}

/* Kajiya and Kay: what a fibre scatters depends on the angles to its direction alone. */
rgb lighting_shade_fibre(const lighting *l, const fibre *f, v3 at, v3 towards) {
  const float facing = v3_dot(f->smooth, l->key);
  const float grazing = clamp01(facing * 4.0f + 0.6f * f->thread);
  const float open = grazing > 0.0f ? grazing * lighting_visibility(l, at, f->smooth) : 0.0f;
  const float tl = v3_dot(f->along, l->key), te = v3_dot(f->along, towards);
  const float sl = sqrtf(clamp01(1.0f - tl * tl)), se = sqrtf(clamp01(1.0f - te * te));
  const v3 normal = v3_unit(v3_add_scaled(f->normal, f->smooth, 0.8f));
  const float lambert = clamp01(v3_dot(normal, l->key));
  const float direct = (lambert + (sl - lambert) * f->thread) * open * f->open;
  float shine = clamp01(sl * se - tl * te);
  for (int k = 0; k < 4; k++) shine *= shine;
  const float fill = clamp01(v3_dot(normal, l->fill) * 0.8f + 0.2f);
  const float sky = 0.5f + 0.5f * normal.y;
  const rgb warm = {1.04f, 0.98f, 0.88f}, cool = {0.80f, 0.92f, 1.08f};
  const float a = 1.15f * direct;
  const float b = (0.16f * fill + 0.20f * sky + 0.06f) * (0.75f + 0.25f * open) * f->open;
  const float d = f->gloss * shine * open * f->open;
  return (rgb){f->colour.r * (a * warm.r + b * cool.r) + d,
               f->colour.g * (a * warm.g + b * cool.g) + d,
               f->colour.b * (a * warm.b + b * cool.b) + d};
}
