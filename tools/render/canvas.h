/* SPDX-License-Identifier: Apache-2.0 */
/* A picture in linear light with a depth buffer, kept at `scale` samples a side per pixel.
 * All coordinates are in final pixels, x to the right, y down; (0, 0) is the corner of the first.
 */
#ifndef FRAY_TOOLS_RENDER_CANVAS_H
#define FRAY_TOOLS_RENDER_CANVAS_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
  float r, g, b; /* linear light, 1 is white */
} rgb;

typedef struct {
  uint32_t width, height; /* final pixels */
  uint32_t scale;         /* 1..4 */
  uint32_t columns, rows; /* samples */
  uint16_t *light;        /* 3 a sample */
  float *depth;           /* larger is nearer; -INFINITY where nothing is */
} canvas;

enum { CANVAS_ATTRIBUTES = 18 };

/* `depth` is linear on the screen: 1/w of a perspective camera, minus the distance of a parallel
 * one. `over_w` is 1/w or 1: attributes are interpolated in space, not on the screen. */
typedef struct {
  float x, y, depth, over_w;
  float a[CANVAS_ATTRIBUTES];
} canvas_vertex;

typedef struct {
  rgb colour;
  float alpha; /* from 1/2 on, the sample hides what lies behind it */
} canvas_sample;

/* `front`: the corners went clockwise on the screen. */
typedef canvas_sample canvas_shader(const void *context, const float *a, int front);

rgb rgb_hex(uint32_t srgb);
rgb rgb_mix(rgb a, rgb b, float share_of_b);
rgb rgb_scale(rgb a, float s);

/* Returns 1, or 0 iff memory ran out or a side is not within 1..16384, scale not within 1..4. */
int canvas_open(canvas *c, uint32_t width, uint32_t height, uint32_t scale);
void canvas_close(canvas *c);
void canvas_fill(canvas *c, rgb top, rgb bottom); /* a vertical gradient; clears the depth */

/* The first `attributes` of the vertices are interpolated. A NULL shader writes depth only. */
void canvas_triangle(canvas *c, const canvas_vertex *v0, const canvas_vertex *v1,
                     const canvas_vertex *v2, uint32_t attributes, canvas_shader *shader,
                     const void *context);

/* Flat ones lie over everything and leave the depth alone. Edges are anti-aliased. */
void canvas_line(canvas *c, float x0, float y0, float x1, float y1, float width, rgb colour,
                 float alpha);
/* As canvas_line(), but what the depth buffer has before it hides it. */
void canvas_wire(canvas *c, const canvas_vertex *from, const canvas_vertex *to, float width,
                 rgb colour, float alpha);
void canvas_disc(canvas *c, float x, float y, float radius, rgb colour, float alpha);
void canvas_box(canvas *c, float x0, float y0, float x1, float y1, rgb colour, float alpha);

/* Box-filters to width x height and encodes as sRGB; `out` holds width * height * 3 bytes. */
void canvas_resolve(const canvas *c, uint8_t *out);
/* Returns 1, or 0 with errno set iff the file could not be written. */
int canvas_write(const canvas *c, const char *path);

#endif
