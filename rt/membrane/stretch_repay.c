/* SPDX-License-Identifier: Apache-2.0 */
/* What a triangle's stiffness has made by following the strain (membrane_stress.c) is taken from the motion
 * that strains it, in the first elastic step of a tick: what the ends of its sides part or meet with. Cloth
 * at rest has no motion, and owes; its force is that of the table. */
#include "rt/elastic/step_repay.h"
#include "rt/membrane/membrane.h"
#include "rt/state/deformation.h"

static int32_t slow_side(fray_world *w, uint32_t t, uint32_t k, int32_t owed, step_energy_unit unit,
                         const elastic_step *step) {
  const index_t *v = w->trimesh.triangle[t].v;
  const uint32_t i = v[trimesh_next(k)];
  const uint32_t j = v[trimesh_previous(k)];
  const elastic_position *place = w->membrane.positions;
  const vec3 d = vec_wrap_sub(vec_of(place[j].at), vec_of(place[i].at));
  const uint64_t squared = vec_squared(d);
  if (squared == 0) return owed;
  const vec3 along = vec_round(vec_root_unit(fx_rsqrt(squared, FX_ROOT_FINE), d), 30 - STEP_MOTION_BITS);
  const step_motion motion = {2, {i, j, 0, 0}, {vec_negated(along), along, {0, 0, 0}, {0, 0, 0}}};
  return step_repay(w, &motion, owed, unit, step);
}

/* From energies to the format of `owed`. */
static step_energy_unit unit_of(const fray_world *w, uint32_t t) {
  const membrane_params *c = w->membrane.constants;
  const uint64_t gain = fx_mul_wide_u((uint32_t)membrane_gain_of(w, t), (uint32_t)c->steps);
  step_energy_unit unit = step_energy_unit_over(gain | 1u);
  unit.bits += c->energy_shift - c->force_shift - 59;
  return unit;
}

static void repay(fray_world *w, uint32_t t, const elastic_step *step) {
  int32_t *const owed = &w->membrane.stiffness[t].owed;
  const step_energy_unit unit = unit_of(w, t);
  for (uint32_t k = 0; k < 3 && *owed > 0; ++k) *owed = slow_side(w, t, k, *owed, unit, step);
}

void stretch_repay(fray_world *w, const elastic_step *step) {
  FRAY_ASSERT(world_has_membrane(w));
  for (uint32_t t = 0; t < triangles_in_use(w); ++t)
    if (w->membrane.stiffness[t].owed > 0) repay(w, t, step);
}
