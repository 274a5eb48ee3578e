/* SPDX-License-Identifier: Apache-2.0 */
/* A change of H (bend_stiffness.c), or of the part of angles that counts (bend_fade.c), is no work, but
 * changes the energy of bent cloth. What it makes, by triangle, is `owed`, until bend_repay.c takes it from
 * the motion that it becomes, and does not count as energy until then; what a change takes is set against
 * that, as far as the triangle still has it. Energies are Q(bend_bits - 3), in a bending step. */
#include "rt/membrane/membrane.h"

/* From the angles of a bending step. */
static int32_t energy_of(const fray_world *w, uint32_t t) {
  const int32_t *angle = w->membrane.moments[t].side;
  int64_t sum = 0;
  for (uint32_t k = 0; k < 3; ++k) {
    const int32_t moment = fx_saturate(fx_round64(bend_plate_moment(w, t, k), 30));
    sum += fx_mul_wide(moment, angle[k]);
  }
  return fx_max(fx_clamp_wide(fx_asr64(sum, 30), BEND_ENERGY_MAX), 0);
}

void bend_owed_begin(fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(end <= triangles_in_use(w));
  for (uint32_t t = first; t < end; ++t) w->membrane.bend_states[t].owed -= energy_of(w, t);
}

void bend_owed_end(fray_world *w, uint32_t first, uint32_t end) {
  FRAY_ASSERT(end <= triangles_in_use(w));
  for (uint32_t t = first; t < end; ++t) {
    int32_t *const owed = &w->membrane.bend_states[t].owed;
    const int32_t now = energy_of(w, t);
    *owed = fx_clamp(*owed + now, -now, BEND_ENERGY_MAX);
  }
}
