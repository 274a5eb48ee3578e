/* SPDX-License-Identifier: Apache-2.0 */
/* The cloth as its yarns: each a spline through its points, over and under the others, with tips
 * that thin and fade out where it is torn. */
#ifndef FRAY_TOOLS_RENDER_YARN_CLOTH_PICTURE_H
#define FRAY_TOOLS_RENDER_YARN_CLOTH_PICTURE_H

#include "tools/render/camera.h"
#include "tools/render/canvas.h"
#include "tools/render/cloth_style.h"
#include "tools/render/lighting.h"
#include "tools/render/picture_source.h"

/* light NULL: depth only, as a shadow map wants it. Returns 0 iff memory ran out. */
int yarn_cloth_picture_draw(canvas *c, const camera *cam, const lighting *light,
                       const picture_source *source, const cloth_style *style);

#endif
