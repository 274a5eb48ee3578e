/* SPDX-License-Identifier: Apache-2.0 */
/* The links of a world as loops and SIMD kernels read them. */
#ifndef FRAY_WOVEN_WOVEN_LINKS_H
#define FRAY_WOVEN_WOVEN_LINKS_H

#include "rt/simd/link_terms.h"
#include "rt/state/world.h"

/* classes: w->woven.link_classes or w->woven.max_links. */
static inline link_view woven_links(const fray_world *w, const link_class *classes) {
  const link_view view = {w->p.x, w->p.y, w->p.z, w->woven.spring_i, w->woven.spring_j, w->woven.spring_kind,
                          classes, w->capacity[POOL_LINK_CLASSES]};
  return view;
}

#endif
