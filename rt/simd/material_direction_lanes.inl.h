/* SPDX-License-Identifier: Apache-2.0 */
/* Scalar twin: material_direction() in rt/state/material.c. */
#ifndef FRAY_SIMD_MATERIAL_DIRECTION_LANES_INL_H
#define FRAY_SIMD_MATERIAL_DIRECTION_LANES_INL_H

#include "rt/simd/divide_lanes.inl.h"
#include "rt/state/material.h"

#ifdef LANES_HAVE_64
LANES_INLINE lanes lanes_mul_q28(lanes a, lanes share) {
  return lanes64_round(lanes64_mul(a, share), STRAIN_BITS);
}

/* Within the first eighth of a turn. */
LANES_INLINE lanes lanes_material_eighth(lanes t) {
  const lanes one = lanes_set(STRAIN_ONE);
  const lanes z = lanes_mul_q28(t, t);
  lanes q = lanes_set(material_arctan[4]);
  LANES_UNROLL
  for (int n = 3; n >= 0; --n) q = lanes_add(lanes_set(material_arctan[n]), lanes_mul_q28(q, z));
  return lanes_mul_q28(t, lanes_add(one, lanes_mul_q28(q, lanes_sub(one, z))));
}

/* Undefined where x and y are both 0. */
LANES_INLINE lanes lanes_material_direction(lanes x, lanes y) {
  const lanes across = lanes_abs(x);
  const lanes eighth =
      lanes_material_eighth(lanes_ratio(lanes_min(across, y), STRAIN_BITS, lanes_max(across, y)));
  const lanes steep = lanes_sub(lanes_set(2 * STRAIN_ONE), eighth);
  const lanes first = lanes_select(lanes_greater(y, across), steep, eighth);
  return lanes_select(lanes_negative(x), lanes_sub(lanes_set(4 * STRAIN_ONE), first), first);
}
#endif

#endif
