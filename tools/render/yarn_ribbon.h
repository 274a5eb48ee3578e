/* SPDX-License-Identifier: Apache-2.0 */
/* Single yarns as round ribbons that face the camera. */
#ifndef FRAY_TOOLS_RENDER_YARN_RIBBON_H
#define FRAY_TOOLS_RENDER_YARN_RIBBON_H

#include "tools/render/camera.h"
#include "tools/render/canvas.h"
#include "tools/render/lighting.h"

enum { YARN_POINTS_MAX = 9 };

typedef struct {
  v3 at[YARN_POINTS_MAX];
  v3 first, last; /* directions at the ends: ribbons that share one join without a seam */
  uint32_t count; /* 2.. */
  float radius_first, radius_last;
  float lift; /* mm towards the camera */
  rgb first_colour, last_colour;
} yarn_ribbon;

/* light NULL: depth only. */
void yarn_ribbon_draw(canvas *c, const camera *cam, const lighting *light, const yarn_ribbon *y);

#endif
