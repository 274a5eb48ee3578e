/* SPDX-License-Identifier: Apache-2.0 */
#include "rt/state/world.h"

#include "rt/base/random.h"
#include "rt/base/hash.h"

void world_kill_spring(fray_world *w, uint32_t row) {
  FRAY_ASSERT(row < w->capacity[POOL_SPRINGS]);
  if (w->woven.spring_kind[row] == SPRING_DEAD) return;
  w->woven.spring_kind[row] = SPRING_DEAD;
  world_toggle(w, TOPOLOGY_SPRING, w->woven.canonical_id[row], SPRING_DEAD);
}

void world_toggle(fray_world *w, uint32_t field, uint32_t id, uint32_t value) {
  FRAY_ASSERT(field >= TOPOLOGY_SPRING && field <= TOPOLOGY_WARP);
  world_toggle_entry(w, hash_entry(field, id, value));
}

void world_toggle_entry(fray_world *w, uint64_t entry) {
  w->state->topology[0] ^= (int32_t)(uint32_t)(entry & 0xFFFFFFFFu);
  w->state->topology[1] ^= (int32_t)(uint32_t)(entry >> 32);
}

uint64_t world_topology(const fray_world *w) {
  uint64_t total = 0;
  if (world_has_membrane(w)) return trimesh_topology(w);
  for (uint32_t row = 0; row < w->capacity[POOL_SPRINGS]; ++row)
    if (w->woven.spring_kind[row] == SPRING_DEAD)
      total ^= hash_entry(TOPOLOGY_SPRING, w->woven.canonical_id[row], SPRING_DEAD);
  if (!world_has_yarns(w)) return total;
  for (uint32_t c = 0; c < w->capacity[POOL_CROSSINGS]; ++c) {
    if (w->woven.crossing_state[c] != FRAY_WHOLE)
      total ^= hash_entry(TOPOLOGY_CROSSING, c, w->woven.crossing_state[c]);
    if (w->woven.warp_particle[c] != w->woven.crossing_particle[c])
      total ^= hash_entry(TOPOLOGY_WARP, c, w->woven.warp_particle[c]);
  }
  return total;
}

/* What a row's draws go by; worlds that are not mirrored need no frame for it. */
__attribute__((noinline)) static uint32_t mirrored(const fray_world *w, uint32_t element) {
  return yarn_grid_mirror(world_yarn_grid(w), element);
}

static inline int32_t drawn(const fray_world *w, uint32_t row, int32_t least, int32_t most) {
  const params *p = w->params;
  uint32_t element = w->woven.canonical_id[row];
  if (p->tear_mirrored != 0) element = mirrored(w, element);
  return random_between((uint32_t)p->seed, element, least, most);
}

int32_t world_tear_strain(const fray_world *w, uint32_t row) {
  FRAY_ASSERT(row < (uint32_t)w->params->links);
  return drawn(w, row, w->params->tear_min, w->params->tear_max);
}

int32_t world_split_strain(const fray_world *w, uint32_t row) {
  FRAY_ASSERT(world_has_yarns(w) && row < (uint32_t)w->params->links);
  return drawn(w, row, w->woven.yarn_constants->split_min, w->woven.yarn_constants->split_max);
}
