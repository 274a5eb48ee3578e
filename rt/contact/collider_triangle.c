/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/contact/collider_triangle.h"

int collider_triangle_begin(fray_world *w, const collider *t, int32_t margin, collider_triangle_query *q) {
  FRAY_ASSERT(margin >= 0 && q->skin >= 0 && q->own_edges < 8u);
  q->ccd_left = RIGID_MESH_CLOSE_CCD;
  for (uint32_t k = 0; k < 3; ++k) {
    if (!collider_is_far(q->path[k].begin) && !collider_is_far(q->path[k].end)) continue;
    world_fault(w, FRAY_FAULT_OUT_OF_WORLD);
    return 0;
  }
  q->span = collider_box_of(q->path, 3, margin);
  if (t->radius != 0) return 1; /* a sphere has one point, its centre */
  collider_list_near(w, t, &q->span, RIGID_MESH_CLOSE, &q->near);
  if (q->near.has_more) world_fault(w, FRAY_FAULT_MESH_QUERY_BUDGET);
  return 1;
}
