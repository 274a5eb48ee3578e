/* SPDX-License-Identifier: Apache-2.0 */
/* Where a yarn touches those that it crosses behind split crossings: places that slide along it. There it
 * runs over or under them; a spacing farther on nothing is left of the wave. */
#ifndef FRAY_TOOLS_RENDER_YARN_TOUCH_H
#define FRAY_TOOLS_RENDER_YARN_TOUCH_H

#include "tools/render/yarn_axes.h"

typedef struct {
  float place; /* in points of the yarn */
  v3 away;     /* unit: from the yarn that it touches */
} yarn_touch_place;

typedef struct {
  yarn_touch_place *list;
  uint32_t count;
} yarn_touches;

/* The list has room for as many as the yarn has points; yarn_path_at() of its points. */
void yarn_touches_read(yarn_touches *t, const yarn_path *path);
/* Away from what the yarn touches near a place, as long as it is near: 0..1; *touch: the same without
 * a direction. */
v3 yarn_touches_at(const yarn_touches *t, float place, float *touch);

#endif
