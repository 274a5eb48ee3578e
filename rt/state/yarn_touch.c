/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/state/yarn_touch.h"

vec3 yarn_touch_gap(const yarn_touch *touch, const yarn_contact *c) {
  const vec3 warp = touch->spot[FRAY_WARP].at; /* curves leave the world by a little: wide differences */
  const vec3 weft = touch->spot[FRAY_WEFT].at;
  const vec3 apart = vec_make(fx_clamp_wide((int64_t)warp.x - weft.x, YARN_GAP_MAX),
                              fx_clamp_wide((int64_t)warp.y - weft.y, YARN_GAP_MAX),
                              fx_clamp_wide((int64_t)warp.z - weft.z, YARN_GAP_MAX));
  return vec_sub(apart, vec_of(c->offset));
}

int yarn_touch_at(const fray_world *w, uint32_t n, yarn_touch *touch) {
  FRAY_ASSERT(n < (uint32_t)w->woven.yarn_counts->split);
  const yarn_contact *c = &w->woven.contacts[n];
  const uint32_t crossing = yarn_contact_crossing(w, n);
  const uint32_t warps = (uint32_t)w->params->warps;
  for (uint32_t axis = 0; axis < 2; ++axis) {
    const uint32_t number = axis == (uint32_t)FRAY_WARP ? crossing % warps : crossing / warps;
    const yarn_line line = yarn_line_of(w, axis, number);
    if (!yarn_spot_at(w, &line, c->place[axis], &touch->spot[axis])) return 0;
  }
  touch->gap = yarn_touch_gap(touch, c);
  return 1;
}
