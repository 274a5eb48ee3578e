/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/render/yarn_touch.h"

/* Along a yarn at a place, without waves; zero where it has no piece. */
static v3 direction_at(const yarn_path *path, float place) {
  const float last = (float)(path->count - 1);
  const float inside = place < 0.0f ? 0.0f : place > last ? last : place;
  uint32_t k = (uint32_t)inside;
  if (!yarn_path_joined(path, k)) {
    if (k == 0 || !yarn_path_joined(path, k - 1)) return (v3){0, 0, 0};
    --k;
  }
  return v3_unit(v3_sub(yarn_path_particle(path, k + 1), yarn_path_particle(path, k)));
}

void yarn_touches_read(yarn_touches *t, const yarn_path *path) {
  const yarn_axes *axes = path->axes;
  const picture_source *s = axes->source;
  t->count = 0;
  for (uint32_t n = 0; n < path->count; n++) {
    const uint32_t crossing = yarn_path_crossing(path, n);
    if (!s->touching[crossing]) continue;
    v3 along[AXES];
    for (int axis = 0; axis < AXES; axis++) {
      const uint32_t number = axis == AXIS_WARP ? crossing % s->warps : crossing / s->warps;
      const yarn_path yarn = yarn_path_of(axes, axis, number);
      along[axis] = direction_at(&yarn, s->place[axis][crossing]);
    }
    /* nearly side by side the two say nothing of the cloth between them */
    v3 normal = v3_cross(along[AXIS_WARP], along[AXIS_WEFT]);
    normal = v3_length(normal) > 0.2f ? v3_unit(normal) : axes->normal[crossing];
    t->list[t->count++] = (yarn_touch_place){s->place[path->axis][crossing],
                                             v3_scale(normal, yarn_axes_side(axes, path->axis, crossing))};
  }
}

v3 yarn_touches_at(const yarn_touches *t, float place, float *touch) {
  v3 away = {0, 0, 0};
  *touch = 0.0f;
  for (uint32_t n = 0; n < t->count; n++) {
    const float far = fabsf(t->list[n].place - place);
    if (far >= 1.0f) continue;
    const float near = (1.0f - far) * (1.0f - far) * (1.0f + 2.0f * far);
    away = v3_add_scaled(away, t->list[n].away, near);
    *touch += near;
  }
  if (*touch > 1.0f) { /* crowded: a mean of them */
    away = v3_scale(away, 1.0f / *touch);
    *touch = 1.0f;
  }
  return away;
}
