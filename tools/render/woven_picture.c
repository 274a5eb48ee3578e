/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/woven_picture.h"

#include <stdlib.h>

#include "tools/render/yarn_ribbon.h"

enum { AT = 0, ALONG_WEFT = 3, ALONG_WARP = 6, COLUMN = 9, ROW = 10, LOAD = 11, CUTS_MAX = 4 };

/* Tangents are per spring length, so a cell is a cubic patch over its four crossings. */
typedef struct {
  canvas *c;
  const camera *cam;
  const lighting *light;
  const picture_source *source;
  const cloth_style *style;
  v3 *along_weft, *along_warp;
  float *load;
  float texture; /* 0..1: fades out where a yarn is thinner than a pixel */
  uint32_t pieces; /* a cell is drawn as pieces x pieces quads */
} sheet_job;

/* The surface of a crossing as the eye meets it: which yarn is on top, how it bends away. */
static canvas_sample shade_cloth(const void *context, const float *a, int front) {
  const sheet_job *k = context;
  const picture_source *s = k->source;
  const v3 at = {a[AT], a[AT + 1], a[AT + 2]};
  const v3 weft = {a[ALONG_WEFT], a[ALONG_WEFT + 1], a[ALONG_WEFT + 2]};
  const v3 warp = {a[ALONG_WARP], a[ALONG_WARP + 1], a[ALONG_WARP + 2]};
  const v3 smooth = v3_scale(v3_unit(v3_cross(warp, weft)), front ? 1.0f : -1.0f);
  const v3 towards = camera_towards(k->cam, at);
  const uint32_t i = (uint32_t)(a[COLUMN] + 0.5f), j = (uint32_t)(a[ROW] + 0.5f);
  const float du = a[COLUMN] - (float)i, dv = a[ROW] - (float)j;
  const int warp_on_top = picture_warp_over(s, i, j) == front;
  const float across = 2.0f * (warp_on_top ? du : dv), along = 2.0f * (warp_on_top ? dv : du);
  /* The yarn dives at the end of the crossing only if its neighbour there is on top next. */
  const uint32_t ni = warp_on_top ? i : along > 0 ? i + 1 : i + s->weave_columns * 8 - 1;
  const uint32_t nj = !warp_on_top ? j : along > 0 ? j + 1 : j + s->weave_rows * 8 - 1;
  const float dive = (picture_warp_over(s, ni, nj) == front) != warp_on_top ? 1.0f : 0.15f;
  const v3 unit_across = v3_unit(warp_on_top ? weft : warp);
  const v3 unit_along = v3_unit(warp_on_top ? warp : weft);
  const float t = k->texture;
  v3 normal = v3_add_scaled(smooth, unit_across, 0.75f * t * across);
  normal = v3_unit(v3_add_scaled(normal, unit_along, 0.55f * t * dive * along));
  const float gap = across * across * across * across, end = along * along * along * along;
  const float shade = 1.0f - t * (0.42f * gap + 0.30f * dive * end);
  rgb colour;
  if (k->style->strain) {
    colour = rgb_scale(cloth_strain_colour(a[LOAD]), 0.35f + 0.65f * shade);
  } else {
    colour = rgb_scale(cloth_yarn_colour(k->style, warp_on_top, warp_on_top ? i : j), shade);
    const rgb mean = rgb_scale(rgb_mix(k->style->warp, k->style->weft, 0.5f), 0.9f);
    colour = rgb_mix(mean, colour, 0.25f + 0.75f * t);
    if (!front) {
      const rgb b = k->style->back;
      colour = (rgb){colour.r * b.r, colour.g * b.g, colour.b * b.b};
    }
  }
  const surface_material m = {colour, 0.22f, 0.0f, 0.30f};
  return (canvas_sample){lighting_shade(k->light, &m, at, normal, smooth, towards), 1.0f};
}

/* Central over living neighbours, one-sided at a cut; zero where the yarn is cut on both sides. */
static v3 tangent(const picture_source *s, uint32_t at, uint32_t step, int before, int after) {
  const v3 here = s->crossings[at];
  const v3 low = before ? s->crossings[at - step] : here;
  const v3 high = after ? s->crossings[at + step] : here;
  return v3_scale(v3_sub(high, low), before && after ? 0.5f : 1.0f);
}

static void measure(sheet_job *k) {
  const picture_source *s = k->source;
  for (uint32_t j = 0; j < s->wefts; j++) {
    for (uint32_t i = 0; i < s->warps; i++) {
      const uint32_t at = j * s->warps + i;
      const uint32_t ends[4] = {i ? picture_weft_spring(s, i - 1, j) : UINT32_MAX,
                                picture_weft_spring(s, i, j),
                                j ? picture_warp_spring(s, i, j - 1) : UINT32_MAX,
                                picture_warp_spring(s, i, j)};
      int alive[4];
      float sum = 0.0f, worst = 0.0f, count = 0.0f;
      for (int e = 0; e < 4; e++) {
        alive[e] = picture_alive(s, ends[e]);
        if (!alive[e]) continue;
        sum += s->load[ends[e]];
        worst = fmaxf(worst, s->load[ends[e]]);
        count += 1.0f;
      }
      k->along_weft[at] = tangent(s, at, 1, alive[0], alive[1]);
      k->along_warp[at] = tangent(s, at, s->warps, alive[2], alive[3]);
      /* Pull is what tears, so one tight spring is not hidden by three slack ones. */
      k->load[at] = worst > 0.0f ? worst : count > 0.0f ? sum / count : 0.0f;
    }
  }
}

static v3 hermite(v3 a, v3 ta, v3 b, v3 tb, float s) {
  const float s2 = s * s, s3 = s2 * s;
  v3 p = v3_scale(a, 2 * s3 - 3 * s2 + 1);
  p = v3_add_scaled(p, ta, s3 - 2 * s2 + s);
  p = v3_add_scaled(p, b, 3 * s2 - 2 * s3);
  return v3_add_scaled(p, tb, s3 - s2);
}

static v3 mix(v3 a, v3 b, float s) { return v3_add_scaled(v3_scale(a, 1.0f - s), b, s); }

/* One point of cell (i, j). On an edge it depends on that edge's crossings alone: no cracks. */
static int cell_vertex(const sheet_job *k, uint32_t i, uint32_t j, float s, float t,
                       canvas_vertex *v) {
  const uint32_t a = j * k->source->warps + i, b = a + 1, c = a + k->source->warps, d = c + 1;
  const v3 *p = k->source->crossings, *u = k->along_weft, *w = k->along_warp;
  const v3 top = hermite(p[a], u[a], p[b], u[b], s), low = hermite(p[c], u[c], p[d], u[d], s);
  const v3 at = hermite(top, mix(w[a], w[b], s), low, mix(w[c], w[d], s), t);
  const v3 weft = mix(mix(u[a], u[b], s), mix(u[c], u[d], s), t);
  const v3 warp = mix(mix(w[a], w[b], s), mix(w[c], w[d], s), t);
  const float *l = k->load;
  const float load = (l[a] * (1 - s) + l[b] * s) * (1 - t) + (l[c] * (1 - s) + l[d] * s) * t;
  const float values[CANVAS_ATTRIBUTES] = {at.x,   at.y,         at.z,         weft.x,
                                           weft.y, weft.z,       warp.x,       warp.y,
                                           warp.z, (float)i + s, (float)j + t, load};
  for (int n = 0; n < CANVAS_ATTRIBUTES; n++) v->a[n] = values[n];
  return camera_project(k->cam, at, v);
}

static void draw_cell(const sheet_job *k, uint32_t i, uint32_t j) {
  canvas_vertex v[(CUTS_MAX + 1) * (CUTS_MAX + 1)];
  const uint32_t n = k->pieces;
  canvas_shader *shader = k->light ? shade_cloth : NULL;
  for (uint32_t y = 0; y <= n; y++)
    for (uint32_t x = 0; x <= n; x++)
      if (!cell_vertex(k, i, j, (float)x / (float)n, (float)y / (float)n, v + y * (n + 1) + x))
        return;
  for (uint32_t y = 0; y < n; y++) {
    for (uint32_t x = 0; x < n; x++) {
      const canvas_vertex *a = v + y * (n + 1) + x, *b = a + 1, *c = a + n + 1, *d = c + 1;
      canvas_triangle(k->c, a, b, d, CANVAS_ATTRIBUTES, shader, k);
      canvas_triangle(k->c, a, d, c, CANVAS_ATTRIBUTES, shader, k);
    }
  }
}

static rgb spring_colour(const sheet_job *k, int warp, uint32_t number, uint32_t crossing) {
  if (k->style->strain) return rgb_scale(cloth_strain_colour(k->load[crossing]), 0.95f);
  return cloth_yarn_colour(k->style, warp, number);
}

/* Off the surface, to the side on which the weave has this yarn. */
static v3 weave_offset(const sheet_job *k, uint32_t i, uint32_t j, int warp) {
  const uint32_t at = j * k->source->warps + i;
  const v3 n = v3_unit(v3_cross(k->along_warp[at], k->along_weft[at]));
  const int above = picture_warp_over(k->source, i, j) == warp;
  return v3_scale(n, (above ? 0.16f : -0.16f) * k->source->spacing);
}

/* A living spring beside an open cell or at the rim. */
static void draw_spring(const sheet_job *k, uint32_t i, uint32_t j, int warp) {
  const picture_source *s = k->source;
  const uint32_t a = j * s->warps + i, b = warp ? a + s->warps : a + 1;
  const v3 *t = warp ? k->along_warp : k->along_weft;
  const v3 oa = weave_offset(k, i, j, warp);
  const v3 ob = weave_offset(k, warp ? i : i + 1, warp ? j + 1 : j, warp);
  yarn_ribbon y = {.count = k->pieces * 2 + 1, .first = t[a], .last = t[b], .lift = 0.10f * s->spacing};
  for (uint32_t n = 0; n < y.count; n++) {
    const float f = (float)n / (float)(y.count - 1);
    const v3 at = hermite(s->crossings[a], t[a], s->crossings[b], t[b], f);
    y.at[n] = v3_add(at, mix(oa, ob, f * f * (3.0f - 2.0f * f)));
  }
  y.radius_first = y.radius_last = 0.30f * s->spacing;
  y.first_colour = spring_colour(k, warp, warp ? i : j, a);
  y.last_colour = spring_colour(k, warp, warp ? i : j, b);
  yarn_ribbon_draw(k->c, k->cam, k->light, &y);
}

/* Half of a cut spring still hangs at this crossing: three filaments that splay and droop. */
static void draw_end(const sheet_job *k, uint32_t i, uint32_t j, int warp, float sign) {
  const picture_source *s = k->source;
  const uint32_t at = j * s->warps + i;
  v3 along = (warp ? k->along_warp : k->along_weft)[at];
  const v3 other = (warp ? k->along_weft : k->along_warp)[at];
  const int held_on = v3_length(along) > 1e-3f * s->spacing;
  if (!held_on) along = v3_cross(other, k->cam->back); /* a piece across one yarn only */
  if (v3_length(along) < 1e-3f * s->spacing) along = (v3){0.7f, 0.0f, 0.7f};
  along = v3_scale(v3_unit(along), sign);
  const v3 side = v3_unit(v3_cross(along, k->cam->back));
  const v3 start = v3_add(s->crossings[at], weave_offset(k, i, j, warp));
  const rgb colour = spring_colour(k, warp, warp ? i : j, at);
  for (uint32_t f = 0; f < 3; f++) {
    const uint32_t seed = (at * 4u + (warp ? 2u : 0u) + (sign > 0 ? 1u : 0u)) * 3u + f;
    const float length = s->spacing * (held_on ? 0.7f + 0.8f * cloth_random(seed) : 0.35f);
    const float splay = 0.30f * ((float)f - 1.0f) + 0.7f * (cloth_random(seed + 7919u) - 0.5f);
    yarn_ribbon y = {.count = 5, .lift = 0.10f * s->spacing, .first = along};
    for (uint32_t n = 0; n < y.count; n++) {
      const float q = (float)n / (float)(y.count - 1);
      v3 p = v3_add_scaled(start, along, length * q);
      p = v3_add_scaled(p, side, length * (0.10f * ((float)f - 1.0f) + splay * q * q * 0.7f));
      p.y -= 0.30f * length * q * q;
      y.at[n] = p;
    }
    y.last = v3_sub(y.at[4], y.at[3]);
    y.radius_first = 0.15f * s->spacing;
    y.radius_last = 0.02f * s->spacing;
    y.first_colour = colour;
    y.last_colour = rgb_scale(colour, 1.12f);
    yarn_ribbon_draw(k->c, k->cam, k->light, &y);
  }
}

static void draw_yarns(const sheet_job *k) {
  const picture_source *s = k->source;
  for (uint32_t j = 0; j < s->wefts; j++) {
    for (uint32_t i = 0; i < s->warps; i++) {
      for (int warp = 0; warp < 2; warp++) {
        const uint32_t n = warp ? picture_warp_spring(s, i, j) : picture_weft_spring(s, i, j);
        if (n == UINT32_MAX) continue;
        if (s->springs[n] == SPRING_CUT) {
          draw_end(k, i, j, warp, 1.0f);
          draw_end(k, warp ? i : i + 1, warp ? j + 1 : j, warp, -1.0f);
        } else if (s->springs[n] == SPRING_ALIVE) {
          const int here = picture_cell_closed(s, i, j);
          const int beside = warp ? i > 0 && picture_cell_closed(s, i - 1, j)
                                  : j > 0 && picture_cell_closed(s, i, j - 1);
          if (!here || !beside) draw_spring(k, i, j, warp);
        }
      }
    }
  }
}

/* How many pixels a cell takes, on average. */
static float cell_pixels(const sheet_job *k) {
  const bounds b = picture_source_bounds(k->source);
  return k->source->spacing * camera_pixels(k->cam, v3_scale(v3_add(b.low, b.high), 0.5f));
}

int woven_picture_draw(canvas *c, const camera *cam, const lighting *light,
                       const picture_source *source, const cloth_style *style) {
  sheet_job k = {.c = c, .cam = cam, .light = light, .source = source, .style = style};
  const size_t crossings = (size_t)source->warps * source->wefts;
  if (crossings == 0) return 1;
  k.along_weft = calloc(crossings, sizeof(v3));
  k.along_warp = calloc(crossings, sizeof(v3));
  k.load = calloc(crossings, sizeof(float));
  const int good = k.along_weft && k.along_warp && k.load;
  if (good) {
    measure(&k);
    const float pixels = cell_pixels(&k);
    k.texture = clamp01((pixels - 2.0f) / 4.0f);
    k.pieces = pixels < 4.0f ? 1 : pixels < 12.0f ? 2 : CUTS_MAX;
    for (uint32_t j = 0; j + 1 < source->wefts; j++)
      for (uint32_t i = 0; i + 1 < source->warps; i++)
        if (picture_cell_closed(source, i, j)) draw_cell(&k, i, j);
    draw_yarns(&k);
  }
  free(k.along_weft);
  free(k.along_warp);
  free(k.load);
  return good;
}
