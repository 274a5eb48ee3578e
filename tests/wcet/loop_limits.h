/* SPDX-License-Identifier: Apache-2.0 */
/* What bounds the loops of a tick of a world, in one line for bound.awk. */
#ifndef FRAY_TESTS_WCET_LOOP_LIMITS_H
#define FRAY_TESTS_WCET_LOOP_LIMITS_H

#include "rt/state/world.h"
#include "rt/woven/woven.h"
#include "tests/wcet/line_words.h"

/* Rows of batches [first, end) with one end in a body. */
static inline uint32_t loop_limits_held_springs(const fray_world *w, int32_t first, int32_t end) {
  uint32_t rows = 0;
  for (int32_t b = first; b < end; ++b)
    if (w->woven.batches[b].attached == BATCH_ATTACHED) rows += (uint32_t)w->woven.batches[b].count;
  return rows;
}
/* Springs so strong that their impulses need more than the upper word of a product. */
static inline uint32_t loop_limits_strong_springs(const fray_world *w) {
  for (uint32_t n = 1; n < w->capacity[POOL_BEND_SHEAR_CLASSES]; ++n)
    if (w->woven.bend_shear_classes[n].shift < 25) return 1;
  return 0;
}
/* How often the kind of living links changes, in their order. */
static inline uint32_t loop_limits_kind_changes(const fray_world *w) {
  uint32_t changes = 0;
  uint32_t kind = SPRING_DEAD;
  for (uint32_t row = 0; row < (uint32_t)w->params->links; ++row) {
    if (w->woven.spring_kind[row] == SPRING_DEAD || w->woven.spring_kind[row] == kind) continue;
    kind = w->woven.spring_kind[row];
    ++changes;
  }
  return changes;
}

static inline void loop_limits_print(const char *name, const fray_world *w) {
  const params *p = w->params;
  const fray_work most = fray_work_bound(w);
  line l = line_begin("limits", name);
  const int32_t batches = (int32_t)w->capacity[POOL_BATCHES];
  const uint32_t yarns = world_has_yarns(w) != 0;
  const uint32_t sheet = world_has_membrane(w) != 0;
  const uint32_t spares =
      yarns != 0 || sheet != 0 ? w->capacity[POOL_PARTICLES] - (uint32_t)p->particles : 0;
  const uint32_t inner = sheet != 0 ? (uint32_t)w->membrane.constants->steps : 0;
  const uint32_t every = sheet != 0 ? (uint32_t)w->membrane.constants->bend_every : 0;
  uint32_t sorts[3] = {0, 0, 0}; /* driven, free, planes */
  uint32_t paths = 0;
  for (uint32_t b = 0; b < (uint32_t)p->bodies; ++b) {
    ++sorts[w->rigid.bodies[b].motion == FRAY_FREE];
    sorts[2] += w->rigid.bodies[b].shape == FRAY_PLANE;
    paths += w->rigid.bodies[b].motion == FRAY_PATH;
  }
  const uint32_t words[] = {(uint32_t)p->warps, (uint32_t)p->substeps, (uint32_t)p->iterations,
                            (uint32_t)p->particles, (uint32_t)p->attached, (uint32_t)p->links,
                            (uint32_t)p->bends, (uint32_t)p->shears, (uint32_t)p->link_batches,
                            (uint32_t)(batches - p->link_batches), sorts[0], sorts[1],
                            sorts[2], (uint32_t)p->tears_max, w->capacity[POOL_CONTACTS],
                            p->drag != 0, p->relative_damping != 0, w->capacity[POOL_KEYS],
                            world_has_elastic_yarns(w) ? 0
                                                       : loop_limits_held_springs(w, 0, p->link_batches) *
                                                             (uint32_t)(p->iterations * p->substeps),
                            loop_limits_strong_springs(w), sizeof(fray_output) + sizeof(fray_work),
                            sizeof(body_motion),
                            most.particle_steps, most.projections, most.springs, most.contacts,
                            most.broad_phase_tests, most.tear_tests, most.over_threshold, most.tears,
                            loop_limits_held_springs(w, p->link_batches, batches), paths,
                            p->tear_mirrored != 0, p->hands != 0, yarns, spares, most.slips, most.splits,
                            yarns != 0 && w->woven.yarn_constants->all_yarn != 0, (uint32_t)p->wefts, most.yarn_forces,
                            world_has_elastic_yarns(w) ? 1u << (uint32_t)w->woven.elastic_params->steps_bits : 0,
                            sheet != 0 ? w->capacity[POOL_TRIANGLES] : 0, inner,
                            every != 0 ? (inner + every - 1u) / every : 0,
                            sheet != 0 ? (uint32_t)w->trimesh.params->materials : 0, loop_limits_kind_changes(w),
                            sheet, most.contact_constraints,
                            world_is_projected(w) && overstretched_links_may_be(w)};
  for (uint32_t m = 0; m < sizeof words / sizeof words[0]; ++m) line_number(&l, words[m]);
  print_line(&l);
}

#endif
