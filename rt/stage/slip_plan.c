/* SPDX-License-Identifier: Apache-2.0 */
/* What a kernel takes of the couples that slip: loose ones, with no end that a body holds. Which springs
 * a couple has, and which of their ends are light, changes between ticks only, so it is looked up once. */
#include "rt/model/couples.h"
#include "rt/stage/slip.h"
#include "rt/wide/wide.h"

#if SLIP_PLANNED
enum { PLAN_FACTS = SLIDE_ENDS, PLAN_CROSSING, PLAN_WORDS };
_Static_assert((int)PLAN_WORDS == (int)SLIP_PLAN_WORDS, "a plan has all that a kernel takes");

static int32_t *array_of(const fray_world *w, uint32_t n) {
  return w->slip_plan + (size_t)n * w->capacity[POOL_CROSSINGS];
}

/* Returns 0 iff the scalar code has to take it. */
static int plan_couple(const fray_world *w, uint32_t c, uint32_t place) {
  const weave_cross cross = weave_cross_at(world_weave(w), c);
  uint32_t facts = couple_warp_over(w, c) ? 0 : (uint32_t)SLIDE_UNDER;
  if (couple_at(w, c) != FRAY_LOOSE) return 0;
  array_of(w, SLIDE_WARP)[place] = (int32_t)w->warp_at[c];
  array_of(w, SLIDE_WEFT)[place] = (int32_t)w->crossing[c];
  for (uint32_t way = 0; way < 4; ++way) {
    const uint32_t next = cross.next[way];
    const int none = next == c || w->row_class[w->row_of[cross.link[way]]] == ROW_DEAD;
    const uint32_t at = none ? c : next;
    const uint32_t p = way < 2 ? w->crossing[at] : w->warp_at[at];
    if (p < (uint32_t)w->params->held) return 0;
    if (none) facts |= (uint32_t)SLIDE_NONE << way;
    if (couple_at(w, at) != FRAY_WHOLE) facts |= (uint32_t)SLIDE_LIGHT << way;
    array_of(w, SLIDE_FAR + way)[place] = (int32_t)p;
  }
  array_of(w, PLAN_FACTS)[place] = (int32_t)facts;
  array_of(w, PLAN_CROSSING)[place] = (int32_t)c;
  return 1;
}

void slip_plan(fray_world *w) {
  uint32_t count = 0;
  for (uint32_t n = 0; n < SLIP_COLOURS; ++n) {
    w->slip_planned[n] = count;
    if (w->kernel == FRAY_KERNEL_SCALAR) continue;
    uint32_t left = SLIP_NOBODY;
    uint32_t next;
    for (uint32_t c = w->slip_head[n]; c != SLIP_NOBODY; c = next) {
      next = w->slip_next[c];
      if (plan_couple(w, c, count)) {
        ++count;
      } else {
        w->slip_next[c] = (row_id)left;
        left = c;
      }
    }
    w->slip_head[n] = left;
  }
  w->slip_planned[SLIP_COLOURS] = count;
}

void slip_run_planned(fray_world *w, uint32_t colour) {
  const slide_view v = {
      {w->x, w->y, w->z},
      {w->qx, w->qy, w->qz},
      {w->vx, w->vy, w->vz},
      {array_of(w, 0), array_of(w, 1), array_of(w, 2), array_of(w, 3), array_of(w, 4), array_of(w, 5)},
      array_of(w, PLAN_FACTS),
      w->params->thickness,
      w->yarns->slip_friction,
      w->yarns->slip_grip};
  const uint32_t end = w->slip_planned[colour + 1u];
  uint32_t at = w->slip_planned[colour];
  w->work.slips += end - at;
  while (at < end) {
    at += wide_slide(w->kernel, &v, at, end);
    if (at < end) slip_couple(w, (uint32_t)array_of(w, PLAN_CROSSING)[at++]);
  }
}
#endif
