/* SPDX-License-Identifier: Apache-2.0 */
/* The cloth as lines: every living structural spring, in one colour where it joins whole crossings
 * and in another where a crossing has split into yarns. Bodies hide them; they hide nothing. */
#ifndef FRAY_TOOLS_RENDER_WIRE_PICTURE_H
#define FRAY_TOOLS_RENDER_WIRE_PICTURE_H

#include "tools/render/camera.h"
#include "tools/render/canvas.h"
#include "tools/render/cloth_style.h"
#include "tools/render/picture_source.h"

void wire_picture_draw(canvas *c, const camera *cam, const picture_source *source,
                       const cloth_style *style);

#endif
