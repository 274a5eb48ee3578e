/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/yarn_ribbon.h"

#include "tools/render/portable_math.h"

enum { AT = 0, SIDE = 3, ACROSS = 6, ALONG = 7, COLOUR = 8, YARN_ATTRIBUTES = 11 };

typedef struct {
  const camera *cam;
  const lighting *light;
} yarn_context;

static canvas_sample shade_yarn(const void *context, const float *a, int front) {
  const yarn_context *k = context;
  (void)front;
  const v3 at = {a[AT], a[AT + 1], a[AT + 2]};
  const v3 towards = camera_towards(k->cam, at);
  const float t = a[ACROSS] < -1.0f ? -1.0f : a[ACROSS] > 1.0f ? 1.0f : a[ACROSS];
  const v3 side = v3_unit((v3){a[SIDE], a[SIDE + 1], a[SIDE + 2]});
  const float bulge = sqrtf(1.0f - 0.9f * t * t);
  const v3 normal = v3_unit(v3_add_scaled(v3_scale(towards, bulge), side, 0.9f * t));
  /* Twist: plies show as slanting bands. */
  const float twist = 1.0f + 0.10f * portable_wave(1.4f * a[ALONG] + 0.35f * t);
  const float edge = 1.0f - 0.45f * t * t * t * t;
  const surface_material m = {rgb_scale((rgb){a[COLOUR], a[COLOUR + 1], a[COLOUR + 2]}, twist * edge), 0.0f,
                      0.0f, 0.15f};
  return (canvas_sample){lighting_shade(k->light, &m, at, normal, normal, towards), 1.0f};
}

static v3 direction_at(const yarn_ribbon *y, uint32_t k) {
  if (k == 0) return y->first;
  if (k + 1 == y->count) return y->last;
  return v3_sub(y->at[k + 1], y->at[k - 1]);
}

static void set_attributes(canvas_vertex *v, v3 at, v3 side, float across, float along,
                           rgb colour) {
  const float values[YARN_ATTRIBUTES] = {at.x,   at.y,  at.z,     side.x,   side.y,  side.z,
                                         across, along, colour.r, colour.g, colour.b};
  for (int k = 0; k < YARN_ATTRIBUTES; k++) v->a[k] = values[k];
}

/* Two vertices at point k, one on each edge of the ribbon. */
static int edge_pair(const camera *cam, const yarn_ribbon *y, uint32_t k, float along,
                     canvas_vertex *pair) {
  const v3 towards = camera_towards(cam, y->at[k]);
  v3 side = v3_cross(v3_unit(direction_at(y, k)), towards);
  if (v3_length(side) < 1e-4f) side = cam->right; /* seen end on */
  side = v3_unit(side);
  const float s = (float)k / (float)(y->count - 1);
  const float radius = y->radius_first + (y->radius_last - y->radius_first) * s;
  const rgb colour = rgb_mix(y->first_colour, y->last_colour, s);
  for (int edge = 0; edge < 2; edge++) {
    const float across = edge ? 1.0f : -1.0f;
    const v3 at = v3_add_scaled(v3_add_scaled(y->at[k], side, across * radius), towards, y->lift);
    if (!camera_project(cam, at, pair + edge)) return 0;
    set_attributes(pair + edge, at, side, across, along, colour);
  }
  return 1;
}

void yarn_ribbon_draw(canvas *c, const camera *cam, const lighting *light, const yarn_ribbon *y) {
  const yarn_context context = {cam, light};
  canvas_shader *shader = light ? shade_yarn : NULL;
  canvas_vertex before[2], now[2];
  float along = 0.0f;
  const float thick = fmaxf(fmaxf(y->radius_first, y->radius_last), 1e-4f);
  for (uint32_t k = 0; k < y->count; k++) {
    if (k > 0) along += v3_length(v3_sub(y->at[k], y->at[k - 1])) / thick;
    if (!edge_pair(cam, y, k, along, now)) return;
    if (k > 0) {
      canvas_triangle(c, &before[0], &before[1], &now[0], YARN_ATTRIBUTES, shader, &context);
      canvas_triangle(c, &before[1], &now[1], &now[0], YARN_ATTRIBUTES, shader, &context);
    }
    before[0] = now[0];
    before[1] = now[1];
  }
}
