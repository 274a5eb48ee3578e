/* SPDX-License-Identifier: Apache-2.0 */
/* What vertices of a triangle sheet weigh, where a body meets them: those at a border and on a tear are
 * lighter than those inside, and a body gets no more than they gained. */
#ifndef FRAY_MODEL_HEFT_H
#define FRAY_MODEL_HEFT_H

#include "rt/model/world.h"

enum { HEFT_BITS = 16, HEFT_PER_BITS = 46 };

/* per_mass: Q46 of 1 / unit; 0: all particles weigh the same. */
typedef struct {
  const uint32_t *mass;
  uint32_t per_mass;
} heft;

static inline heft heft_of(const fray_world *w) {
  const int all_alike = !world_has_sheet(w);
  const heft h = {all_alike ? 0 : w->sheet.mass,
                  all_alike ? 0 : fx_divide_wide((uint64_t)1 << HEFT_PER_BITS, (uint32_t)w->cloths->unit)};
  return h;
}

/* Q16 of particle_mass. */
static inline int32_t heft_at(const heft *h, uint32_t p) {
  const uint64_t whole = (uint64_t)h->mass[p] * h->per_mass >> (HEFT_PER_BITS - HEFT_BITS);
  return whole > INT32_MAX ? INT32_MAX : (int32_t)whole;
}

/* The product in so many bits more than the way has. */
static inline int64_t heft_times(int32_t mass, int32_t way, unsigned more) {
  return fx_round64(fx_mul_wide(mass, way), HEFT_BITS - more);
}

#endif
