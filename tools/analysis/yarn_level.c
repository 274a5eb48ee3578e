/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/analysis/yarn_level.h"

#include "rt/image/image.h"

/* Elements of an array that the same cloth without yarns would not have. */
static uint32_t elements_of(const fray_world *w, const image_array *a, uint32_t all) {
  const params *p = w->params;
  if (all == 0) return 0;
  if (a->only == POOL_SPLITS) return all;
  if (a->pool == POOL_PARTICLES) return all - (uint32_t)p->particles;
  if (a->pool == POOL_SPRINGS) return (uint32_t)p->shears;
  return a->pool == POOL_BATCHES ? (uint32_t)p->shear_batches : 0;
}

yarn_level yarn_level_of(const fray_world *w) {
  yarn_level y = {0, 0, 0, 0};
  fray_pool pool;
  if (!world_has_yarns(w)) return y;
  const uint32_t free_crossings = w->capacity[POOL_CROSSINGS] - w->capacity[POOL_ATTACHED];
  y.spares = w->capacity[POOL_PARTICLES] - (uint32_t)w->params->particles;
  y.couples = y.spares < free_crossings ? y.spares : free_crossings;
  y.splits = w->capacity[POOL_SPLITS];
  for (uint32_t n = 0; fray_view_pool(w, n, &pool); ++n)
    if (!pool.in_place)
      y.bytes += (size_t)elements_of(w, &image_arrays[n], pool.count) * pool.element_bytes;
  return y;
}

void yarn_level_print(const fray_world *w, FILE *out) {
  const yarn_level y = yarn_level_of(w);
  if (y.splits == 0) return;
  fprintf(
      out,
      "yarns      %u spare particles, at most %u split crossings, %u splits a tick, %zu bytes of memory\n",
      y.spares, y.couples, y.splits, y.bytes);
}
