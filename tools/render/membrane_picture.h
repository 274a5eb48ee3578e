/* SPDX-License-Identifier: Apache-2.0 */
/* A membrane: smooth cloth, or colours of its stress; where it tore in red, where it was cut in
 * green. */
#ifndef FRAY_TOOLS_RENDER_MEMBRANE_PICTURE_H
#define FRAY_TOOLS_RENDER_MEMBRANE_PICTURE_H

#include "tools/render/camera.h"
#include "tools/render/canvas.h"
#include "tools/render/cloth_style.h"
#include "tools/render/lighting.h"
#include "tools/render/picture_source.h"

/* light NULL: depth only. Returns 0 iff memory ran out. */
int membrane_picture_draw(canvas *c, const camera *cam, const lighting *light, const picture_source *source,
                          const cloth_style *style);

#endif
