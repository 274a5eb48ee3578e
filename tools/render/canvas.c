/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/canvas.h"

#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/render/png.h"
#include "tools/render/portable_math.h"

enum { SIDE_MAX = 16384, SCALE_MAX = 4, GAMMA_STEPS = 4096 };

static float from_srgb(float v) {
  if (v <= 0.04045f) return v / 12.92f;
  return (float)portable_power(portable_root(((double)v + 0.055) / 1.055, 5), 12);
}

static float to_srgb(float v) {
  if (v <= 0.0031308f) return v * 12.92f;
  return (float)(1.055 * portable_power(portable_root((double)v, 12), 5) - 0.055);
}

rgb rgb_hex(uint32_t srgb) {
  return (rgb){from_srgb((float)(srgb >> 16 & 255u) / 255.0f),
               from_srgb((float)(srgb >> 8 & 255u) / 255.0f),
               from_srgb((float)(srgb & 255u) / 255.0f)};
}

rgb rgb_mix(rgb a, rgb b, float s) {
  return (rgb){a.r + (b.r - a.r) * s, a.g + (b.g - a.g) * s, a.b + (b.b - a.b) * s};
}

rgb rgb_scale(rgb a, float s) { return (rgb){a.r * s, a.g * s, a.b * s}; }

int canvas_open(canvas *c, uint32_t width, uint32_t height, uint32_t scale) {
  memset(c, 0, sizeof *c);
  if (width < 1 || height < 1 || width > SIDE_MAX || height > SIDE_MAX) return 0;
  if (scale < 1 || scale > SCALE_MAX) return 0;
  c->width = width;
  c->height = height;
  c->scale = scale;
  c->columns = width * scale;
  c->rows = height * scale;
  const size_t samples = (size_t)c->columns * c->rows;
  c->light = calloc(samples, 3 * sizeof *c->light);
  c->depth = malloc(samples * sizeof *c->depth);
  if (!c->light || !c->depth) {
    canvas_close(c);
    return 0;
  }
  for (size_t k = 0; k < samples; k++) c->depth[k] = -INFINITY;
  return 1;
}

void canvas_close(canvas *c) {
  free(c->light);
  free(c->depth);
  memset(c, 0, sizeof *c);
}

static uint16_t light_of(float v) {
  return v <= 0.0f ? 0 : v >= 1.0f ? 65535 : (uint16_t)(v * 65535.0f + 0.5f);
}

void canvas_fill(canvas *c, rgb top, rgb bottom) {
  for (uint32_t y = 0; y < c->rows; y++) {
    const rgb v = rgb_mix(top, bottom, ((float)y + 0.5f) / (float)c->rows);
    const uint16_t light[3] = {light_of(v.r), light_of(v.g), light_of(v.b)};
    const size_t row = (size_t)y * c->columns;
    for (size_t k = row; k < row + c->columns; k++) {
      memcpy(c->light + 3 * k, light, sizeof light);
      c->depth[k] = -INFINITY;
    }
  }
}

static void blend(canvas *c, size_t at, rgb colour, float alpha) {
  uint16_t *p = c->light + 3 * at;
  if (alpha >= 1.0f) {
    p[0] = light_of(colour.r);
    p[1] = light_of(colour.g);
    p[2] = light_of(colour.b);
    return;
  }
  const float under = (1.0f - alpha) / 65535.0f;
  p[0] = light_of(colour.r * alpha + (float)p[0] * under);
  p[1] = light_of(colour.g * alpha + (float)p[1] * under);
  p[2] = light_of(colour.b * alpha + (float)p[2] * under);
}

static uint32_t bounded(double v, uint32_t limit) {
  return v <= 0.0 ? 0 : v >= (double)limit ? limit : (uint32_t)v;
}

typedef struct {
  double w0, dx, dy; /* w0 at sample (0, 0) */
} plane;

/* The share of a corner over the samples: 1 there, 0 on the side opposite, from a to b. */
static plane share_plane(double ax, double ay, double bx, double by, double twice_area) {
  plane p = {0, (ay - by) / twice_area, (bx - ax) / twice_area};
  p.w0 = -(p.dx * ax + p.dy * ay) + 0.5 * (p.dx + p.dy);
  return p;
}

typedef struct {
  const canvas_vertex *v[3];
  uint32_t attributes;
  canvas_shader *shader;
  const void *context;
  int front;
} fill_job;

static void fill_sample(canvas *c, size_t at, const fill_job *job, const float *s) {
  const float depth = s[0] * job->v[0]->depth + s[1] * job->v[1]->depth + s[2] * job->v[2]->depth;
  if (depth <= c->depth[at]) return;
  if (!job->shader) {
    c->depth[at] = depth;
    return;
  }
  float a[CANVAS_ATTRIBUTES];
  const float q[3] = {s[0] * job->v[0]->over_w, s[1] * job->v[1]->over_w, s[2] * job->v[2]->over_w};
  const float w = 1.0f / (q[0] + q[1] + q[2]);
  for (uint32_t k = 0; k < job->attributes; k++)
    a[k] = (q[0] * job->v[0]->a[k] + q[1] * job->v[1]->a[k] + q[2] * job->v[2]->a[k]) * w;
  const canvas_sample out = job->shader(job->context, a, job->front);
  if (out.alpha <= 0.0f) return;
  blend(c, at, out.colour, out.alpha);
  if (out.alpha >= 0.5f) c->depth[at] = depth;
}

void canvas_triangle(canvas *c, const canvas_vertex *v0, const canvas_vertex *v1,
                     const canvas_vertex *v2, uint32_t attributes, canvas_shader *shader,
                     const void *context) {
  const double s = c->scale;
  const double x[3] = {v0->x * s, v1->x * s, v2->x * s}, y[3] = {v0->y * s, v1->y * s, v2->y * s};
  const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
  if (!(fabs(area) > 1e-9) || !isfinite(area)) return;
  const fill_job job = {{v0, v1, v2}, attributes, shader, context, area > 0.0};
  const plane p[3] = {share_plane(x[1], y[1], x[2], y[2], area),
                      share_plane(x[2], y[2], x[0], y[0], area),
                      share_plane(x[0], y[0], x[1], y[1], area)};
  const uint32_t left = bounded(floor(fmin(x[0], fmin(x[1], x[2]))), c->columns);
  const uint32_t right = bounded(ceil(fmax(x[0], fmax(x[1], x[2]))), c->columns);
  const uint32_t top = bounded(floor(fmin(y[0], fmin(y[1], y[2]))), c->rows);
  const uint32_t bottom = bounded(ceil(fmax(y[0], fmax(y[1], y[2]))), c->rows);
  /* Neighbours overlap by a hair rather than leave a gap; the depth test decides. */
  const double slack = -1e-7;
  for (uint32_t row = top; row < bottom; row++) {
    for (uint32_t column = left; column < right; column++) {
      double w[3];
      for (int k = 0; k < 3; k++) w[k] = p[k].w0 + p[k].dx * column + p[k].dy * row;
      if (w[0] < slack || w[1] < slack || w[2] < slack) continue;
      const float share[3] = {(float)w[0], (float)w[1], (float)w[2]};
      fill_sample(c, (size_t)row * c->columns + column, &job, share);
    }
  }
}

/* In samples. */
typedef struct {
  double x0, y0, x1, y1, half;
  float depth0, depth1;
  rgb colour;
  float alpha;
} segment;

/* How far a place is from the segment; *share: how far along it is nearest. */
static double to_segment(const segment *l, double px, double py, double *share) {
  const double dx = l->x1 - l->x0, dy = l->y1 - l->y0, square = dx * dx + dy * dy;
  double t = square > 0.0 ? ((px - l->x0) * dx + (py - l->y0) * dy) / square : 0.0;
  t = t < 0.0 ? 0.0 : t > 1.0 ? 1.0 : t;
  const double ox = px - l->x0 - t * dx, oy = py - l->y0 - t * dy;
  *share = t;
  return sqrt(ox * ox + oy * oy);
}

static void draw_segment(canvas *c, const segment *l) {
  if (!isfinite(l->x0 + l->y0 + l->x1 + l->y1)) return;
  const double reach = l->half + 1.0;
  const uint32_t top = bounded(floor(fmin(l->y0, l->y1) - reach), c->rows);
  const uint32_t bottom = bounded(ceil(fmax(l->y0, l->y1) + reach), c->rows);
  for (uint32_t row = top; row < bottom; row++) {
    /* Only the columns near the segment in this row: long slanted lines stay cheap. */
    double from = fmin(l->x0, l->x1), to = fmax(l->x0, l->x1);
    if (fabs(l->y1 - l->y0) > 1e-9 && fabs(l->x1 - l->x0) > 1e-9) {
      const double slope = (l->x1 - l->x0) / (l->y1 - l->y0);
      const double steep = sqrt(1.0 + slope * slope) * reach;
      const double middle = l->x0 + slope * ((double)row + 0.5 - l->y0);
      from = fmax(from, middle - steep);
      to = fmin(to, middle + steep);
    }
    const uint32_t left = bounded(floor(from - reach), c->columns);
    const uint32_t right = bounded(ceil(to + reach), c->columns);
    for (uint32_t column = left; column < right; column++) {
      double along;
      const double d = to_segment(l, (double)column + 0.5, (double)row + 0.5, &along);
      const double cover = l->half - d + 0.5;
      if (cover <= 0.0) continue;
      const size_t at = (size_t)row * c->columns + column;
      if (l->depth0 + (l->depth1 - l->depth0) * (float)along < c->depth[at]) continue;
      blend(c, at, l->colour, (cover < 1.0 ? (float)cover : 1.0f) * l->alpha);
    }
  }
}

void canvas_line(canvas *c, float x0, float y0, float x1, float y1, float width, rgb colour,
                 float alpha) {
  const double s = c->scale;
  const segment l = {(double)x0 * s, (double)y0 * s, (double)x1 * s, (double)y1 * s,
                     0.5 * (double)width * s, FLT_MAX, FLT_MAX, colour, alpha};
  draw_segment(c, &l);
}

void canvas_wire(canvas *c, const canvas_vertex *from, const canvas_vertex *to, float width,
                 rgb colour, float alpha) {
  const double s = c->scale;
  const segment l = {(double)from->x * s, (double)from->y * s, (double)to->x * s,
                     (double)to->y * s,   0.5 * (double)width * s, from->depth, to->depth,
                     colour,              alpha};
  draw_segment(c, &l);
}

void canvas_disc(canvas *c, float x, float y, float radius, rgb colour, float alpha) {
  canvas_line(c, x, y, x, y, 2.0f * radius, colour, alpha);
}

void canvas_box(canvas *c, float x0, float y0, float x1, float y1, rgb colour, float alpha) {
  const double s = c->scale;
  const uint32_t left = bounded(x0 * s + 0.5, c->columns),
                 right = bounded(x1 * s + 0.5, c->columns);
  const uint32_t top = bounded(y0 * s + 0.5, c->rows), bottom = bounded(y1 * s + 0.5, c->rows);
  for (uint32_t row = top; row < bottom; row++)
    for (uint32_t column = left; column < right; column++)
      blend(c, (size_t)row * c->columns + column, colour, alpha);
}

void canvas_resolve(const canvas *c, uint8_t *out) {
  uint8_t table[GAMMA_STEPS + 1];
  for (int k = 0; k <= GAMMA_STEPS; k++) {
    /* The table is over the square root of light: dark tones get as many steps as they need. */
    const float root = (float)k / GAMMA_STEPS;
    table[k] = (uint8_t)(to_srgb(root * root) * 255.0f + 0.5f);
  }
  const uint32_t s = c->scale;
  const float norm = 1.0f / (65535.0f * (float)(s * s));
  for (uint32_t y = 0; y < c->height; y++) {
    for (uint32_t x = 0; x < c->width; x++) {
      uint32_t sum[3] = {0};
      for (uint32_t dy = 0; dy < s; dy++) {
        const uint16_t *p = c->light + 3 * ((size_t)(y * s + dy) * c->columns + (size_t)x * s);
        for (uint32_t dx = 0; dx < s; dx++, p += 3) {
          sum[0] += p[0];
          sum[1] += p[1];
          sum[2] += p[2];
        }
      }
      for (int k = 0; k < 3; k++)
        *out++ = table[(int)(sqrtf((float)sum[k] * norm) * (float)GAMMA_STEPS + 0.5f)];
    }
  }
}

int canvas_write(const canvas *c, const char *path) {
  uint8_t *pixels = malloc((size_t)c->width * c->height * 3);
  if (!pixels) {
    errno = ENOMEM;
    return 0;
  }
  canvas_resolve(c, pixels);
  const int good = png_write(path, pixels, c->width, c->height);
  free(pixels);
  return good;
}
