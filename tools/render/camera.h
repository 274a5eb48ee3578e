/* SPDX-License-Identifier: Apache-2.0 */
/* Where a picture is taken from. Lengths are millimetres, y is up. */
#ifndef FRAY_TOOLS_RENDER_CAMERA_H
#define FRAY_TOOLS_RENDER_CAMERA_H

#include "tools/render/canvas.h"
#include "tools/render/vec3.h"

typedef struct {
  v3 low, high;
} bounds;

typedef struct {
  v3 eye;
  v3 right, up, back; /* unit, right-handed; the camera looks against `back` */
  float pixels;       /* perspective: pixels at distance 1; parallel: pixels per millimetre */
  float x, y;         /* the picture's centre */
  int parallel;
} camera;

bounds bounds_none(void);
void bounds_add(bounds *b, v3 p);
void bounds_join(bounds *b, bounds other);
/* A run's bounds without what flew off: at most 0.18 of the diagonal beyond the start. A
 * piece that falls away would else make everything small. */
bounds bounds_within(bounds run, bounds start);

camera camera_look_at(v3 eye, v3 target, float field_degrees, uint32_t width, uint32_t height);
/* Frames all of b from a direction: yaw about y from +z towards +x, pitch upwards, in degrees. */
camera camera_frame(bounds b, float yaw, float pitch, uint32_t width, uint32_t height);
/* Half from the right and a little from above; from higher up the flatter b lies. */
camera camera_default(bounds b, uint32_t width, uint32_t height);
/* Parallel light along -direction over all of b. */
camera camera_light(bounds b, v3 direction, uint32_t side);

/* Fills all of *v but the attributes. Returns 0 iff p is not before the camera. */
int camera_project(const camera *cam, v3 p, canvas_vertex *v);
/* Unit, from p towards the camera. */
v3 camera_towards(const camera *cam, v3 p);
/* Pixels that one millimetre takes at p. */
float camera_pixels(const camera *cam, v3 p);

#endif
