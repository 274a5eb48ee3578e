/* SPDX-License-Identifier: Apache-2.0 */
/* Coulomb's law for displacements: the one place of it in scalar code. Its twin in lanes, with the same
 * rounding, is simd/ground_contact_lanes.inl.h. */
#ifndef FRAY_BASE_COULOMB_H
#define FRAY_BASE_COULOMB_H

#include "rt/base/vec.h"

/* The most slip that friction takes back: `friction` (Q16, not negative) times the depth of the push,
 * `pressed`, and what holds without one, `adhesion`. */
static inline int32_t coulomb_limit(int32_t pressed, int32_t friction, int32_t adhesion) {
  FRAY_ASSERT(pressed >= 0 && friction >= 0 && adhesion >= 0);
  return fx_saturate(adhesion + (fx_mul_wide(pressed, friction) >> 16));
}

/* What friction takes back of a slip: all of it inside the friction cone, else the limit in its direction. */
static inline vec3 coulomb_limited(vec3 slip, int32_t pressed, int32_t friction) {
  return vec_limited(slip, coulomb_limit(pressed, friction, 0));
}

#endif
