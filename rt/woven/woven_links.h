/* SPDX-License-Identifier: Apache-2.0 */
/* The links of a world as loops and SIMD kernels read them. */
#ifndef FRAY_WOVEN_WOVEN_LINKS_H
#define FRAY_WOVEN_WOVEN_LINKS_H

#include "rt/simd/link_terms.h"
#include "rt/state/world.h"

static inline link_view woven_links(const fray_world *w) {
  const link_view view = {w->p.x, w->p.y, w->p.z, w->woven.spring_i, w->woven.spring_j, w->woven.spring_kind,
                          w->woven.link_classes, w->capacity[POOL_LINK_CLASSES], 0};
  return view;
}

/* The diagonals of a world with a shear lock, as links of its two last classes. */
static inline link_view woven_diagonals(const fray_world *w) {
  FRAY_ASSERT(world_has_shear_lock(w));
  link_view view = woven_links(w);
  view.classes += CLASS_LOCK - CLASS_SHEAR;
  view.class_count = CLASSES_WITH_LOCK - (CLASS_LOCK - CLASS_SHEAR);
  view.is_lock = 1;
  return view;
}

#endif
