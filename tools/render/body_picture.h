/* SPDX-License-Identifier: Apache-2.0 */
/* Rigid bodies and the ground. */
#ifndef FRAY_TOOLS_RENDER_BODY_PICTURE_H
#define FRAY_TOOLS_RENDER_BODY_PICTURE_H

#include "tools/render/camera.h"
#include "tools/render/canvas.h"
#include "tools/render/lighting.h"
#include "tools/render/picture_source.h"

rgb body_picture_colour(const picture_body *b);

/* Balls, boxes and bars; planes are left to body_picture_draw_ground(), anchors to body_picture_draw_pins(). light NULL:
 * depth only. */
void body_picture_draw(canvas *c, const camera *cam, const lighting *light, const picture_body *b);

/* A small head on every crossing that an anchor holds. */
void body_picture_draw_pins(canvas *c, const camera *cam, const lighting *light, const picture_source *source);

/* A plane through `at`: a faint grid (grid_mm > 0) that fades out at `reach_mm`, and shadows. */
void body_picture_draw_ground(canvas *c, const camera *cam, const lighting *light, v3 at, v3 normal,
                 float reach_mm, float grid_mm);

#endif
