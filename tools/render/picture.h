/* SPDX-License-Identifier: Apache-2.0 */
/* A whole picture of a world: background, ground, bodies, cloth, caption. */
#ifndef FRAY_TOOLS_RENDER_PICTURE_H
#define FRAY_TOOLS_RENDER_PICTURE_H

#include "rt/fray.h"
#include "tools/render/camera.h"
#include "tools/render/canvas.h"
#include "tools/render/picture_source.h"
#include "tools/render/woven_picture.h"

typedef struct {
  cloth_style cloth;
  rgb top, bottom;     /* background */
  bounds frame;        /* what the run's camera frames: ground and shadows keep still with it */
  const char *caption; /* below left; NULL: none */
  int ground;          /* its planes, or, where it has none, a faint floor below the frame */
} picture_style;

picture_style picture_style_default(bounds frame, cloth_look look);

/* What a picture of this world, as it stands, has to show. Over a run: bounds_join() them, then
 * bounds_within() the start. */
bounds picture_bounds(const fray_world *world);

/* Returns 0 iff memory ran out. The canvas is overwritten. */
int picture_draw(canvas *c, const camera *cam, const picture_source *source,
                 const picture_style *style);
int picture_draw_world(canvas *c, const camera *cam, const fray_world *world,
                  const picture_style *style);

/* Draws at 2x2 samples a pixel and writes a PNG. Returns 1, or 0 with errno set. */
int picture_write(const fray_world *world, const camera *cam, const picture_style *style,
                  uint32_t width, uint32_t height, const char *path);

#endif
