/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns cut before tick 0. A slit opens what a tear would: with yarns the ends of every cut spring are
 * split first, and a crossing whose weft or warp has no link left is none any more. */
#include "rt/state/crossing.h"
#include "tools/scene_compiler/draft.h"

static int split_end(const draft *d, fray_world *w, const scene_slit *slit, uint32_t crossing) {
  if (crossing_is_attached(w, crossing)) return 1;
  if (crossing_state_at(w, crossing) == FRAY_CONNECTED) crossing_set_state(w, crossing, FRAY_LOOSE);
  if (crossing_state_at(w, crossing) != FRAY_WHOLE || crossing_split(w, crossing, FRAY_LOOSE)) return 1;
  return draft_refuse(d, slit->place,
                      "found too few spare_particles in limits, expected one for each crossing beside "
                      "a slit");
}

static int cut_link(const draft *d, fray_world *w, const scene_slit *slit, uint32_t link) {
  uint32_t released[YARN_GRID_RELEASED];
  uint32_t ends[2];
  yarn_grid_ends(d->grid, link, &ends[0], &ends[1]);
  if (world_has_yarns(w) && (!split_end(d, w, slit, ends[0]) || !split_end(d, w, slit, ends[1])))
    return 0;
  const uint32_t count = yarn_grid_released(d->grid, link, released);
  world_kill_spring(w, w->woven.spring_of[link]);
  for (uint32_t n = 0; n < count; ++n) {
    world_kill_spring(w, w->woven.spring_of[released[n]]);
    if (world_has_yarns(w) && released[n] >= yarn_grid_links(d->grid) + yarn_grid_bends(d->grid))
      world_kill_spring(w, w->woven.spring_of[released[n] + yarn_grid_shears(d->grid)]);
  }
  return 1;
}

/* axis: 0 of the weft, 1 of the warp. */
static int has_link(const fray_world *w, uint32_t crossing, uint32_t axis) {
  for (uint32_t direction = 2 * axis; direction < 2 * axis + 2; ++direction) {
    uint32_t next;
    uint32_t link;
    if (yarn_grid_step(world_yarn_grid(w), crossing, direction, &next, &link) &&
        w->woven.spring_kind[w->woven.spring_of[link]] != SPRING_DEAD)
      return 1;
  }
  return 0;
}

static void disconnect_ends(fray_world *w) {
  if (!world_has_yarns(w)) return;
  for (uint32_t p = (uint32_t)w->params->particles; p < w->p.count; ++p) {
    const uint32_t crossing = w->woven.crossing_of[p];
    if (!has_link(w, crossing, 0) || !has_link(w, crossing, 1)) crossing_set_state(w, crossing, FRAY_DISCONNECTED);
  }
}

int draft_slits(const draft *d, fray_world *w) {
  for (uint32_t n = 0; n < d->scene->slit_count; ++n) {
    const scene_slit *slit = &d->scene->slits[n];
    for (uint32_t at = slit->first; at <= slit->last; ++at) {
      const uint32_t link =
          slit->beside_weft
              ? d->grid.wefts * (d->grid.warps - 1u) + slit->yarn * d->grid.warps + at
              : at * (d->grid.warps - 1u) + slit->yarn;
      if (!cut_link(d, w, slit, link)) return 0;
    }
  }
  disconnect_ends(w);
  return 1;
}
