/* SPDX-License-Identifier: Apache-2.0 */
/* The crossings that SIMD kernels slip: loose ones without an attached end. The springs of a crossing, and
 * which of their ends have half the mass, change between ticks only, so both are looked up once a tick. */
#include "rt/simd/simd.h"
#include "rt/state/crossing.h"
#include "rt/woven/yarn_slip.h"

#if SLIP_LISTED
/* A column of slip_list: particles by slip_view.end, then these. */
enum { COLUMN_FACTS = SLIP_ENDS, COLUMN_CROSSING, COLUMNS };
_Static_assert((int)COLUMNS == (int)SLIP_LIST_WORDS, "the list has a column for all that a kernel reads");

static int32_t *column(const fray_world *w, uint32_t n) {
  return w->woven.slip_list + (size_t)n * w->capacity[POOL_CROSSINGS];
}

/* Writes a crossing to a row of the list. Returns 0 iff the scalar code must process it. */
static int list_crossing(const fray_world *w, uint32_t c, uint32_t row) {
  FRAY_ASSERT(c < w->capacity[POOL_CROSSINGS] && row < w->capacity[POOL_CROSSINGS]);
  const yarn_grid_neighbours around = yarn_grid_neighbours_at(world_yarn_grid(w), c);
  uint32_t facts = crossing_warp_over(w, c) ? 0 : (uint32_t)SLIP_UNDER;
  if (crossing_state_at(w, c) != FRAY_LOOSE) return 0;
  column(w, SLIP_WARP)[row] = (int32_t)w->woven.warp_particle[c];
  column(w, SLIP_WEFT)[row] = (int32_t)w->woven.crossing_particle[c];
  for (uint32_t direction = 0; direction < 4; ++direction) {
    const uint32_t next = around.next[direction];
    const int missing =
        next == c || w->woven.spring_kind[w->woven.spring_of[around.link[direction]]] == SPRING_DEAD;
    const uint32_t end = missing ? c : next;
    const uint32_t p = direction < 2 ? w->woven.crossing_particle[end] : w->woven.warp_particle[end];
    if (p < particles_attached(w)) return 0;
    if (missing) facts |= (uint32_t)SLIP_END_MISSING << direction;
    if (crossing_state_at(w, end) != FRAY_WHOLE) facts |= (uint32_t)SLIP_LIGHT << direction;
    column(w, SLIP_FAR + direction)[row] = (int32_t)p;
  }
  column(w, COLUMN_FACTS)[row] = (int32_t)facts;
  column(w, COLUMN_CROSSING)[row] = (int32_t)c;
  return 1;
}

void yarn_slip_list_fill(fray_world *w) {
  FRAY_ASSERT(world_has_yarns(w));
  uint32_t count = 0;
  for (uint32_t n = 0; n < SLIP_COLOURS; ++n) {
    w->woven.slip_list_from[n] = count;
    if (w->kernel == FRAY_KERNEL_SCALAR) continue;
    uint32_t scalar = SLIP_LIST_END;
    uint32_t next;
    for (uint32_t c = w->woven.slip_head[n]; c != SLIP_LIST_END; c = next) {
      next = w->woven.slip_next[c];
      if (list_crossing(w, c, count)) {
        ++count;
      } else {
        w->woven.slip_next[c] = (index_t)scalar;
        scalar = c;
      }
    }
    w->woven.slip_head[n] = scalar;
  }
  w->woven.slip_list_from[SLIP_COLOURS] = count;
}

void yarn_slip_list_solve(fray_world *w, uint32_t colour) {
  FRAY_ASSERT(world_has_yarns(w) && colour < SLIP_COLOURS);
  const yarn_slip_view v = {{w->p.x, w->p.y, w->p.z},
                       {w->p.qx, w->p.qy, w->p.qz},
                       {w->p.vx, w->p.vy, w->p.vz},
                       {column(w, 0), column(w, 1), column(w, 2), column(w, 3), column(w, 4), column(w, 5)},
                       column(w, COLUMN_FACTS),
                       w->params->thickness,
                       w->woven.yarn_constants->slip_friction,
                       w->woven.yarn_constants->crossing_friction};
  const uint32_t end = w->woven.slip_list_from[colour + 1u];
  uint32_t row = w->woven.slip_list_from[colour];
  FRAY_ASSERT(row <= end && end <= w->capacity[POOL_CROSSINGS]);
  w->work.slips += end - row;
  while (row < end) {
    row += simd_yarn_slip(w->kernel, &v, row, end);
    if (row < end) yarn_slip_crossing(w, (uint32_t)column(w, COLUMN_CROSSING)[row++]);
  }
}
#endif
