/* SPDX-License-Identifier: Apache-2.0 */
/* Directions in lanes, exactly those of fabric_direction(). */
#ifndef FRAY_WIDE_DIRECTION_H
#define FRAY_WIDE_DIRECTION_H

#include "rt/model/fabric.h"
#include "rt/wide/divide.h"

#ifdef LANES_LONGS
LANES_INLINE lanes lanes_share(lanes a, lanes share) { return longs_round(longs_mul(a, share), STRAIN_BITS); }

/* Within the first eighth of a turn. */
LANES_INLINE lanes lanes_eighth(lanes t) {
  const lanes one = lanes_all(STRAIN_ONE);
  const lanes z = lanes_share(t, t);
  lanes q = lanes_all(fabric_eighth[4]);
  LONGS_UNROLLED
  for (int n = 3; n >= 0; --n) q = lanes_add(lanes_all(fabric_eighth[n]), lanes_share(q, z));
  return lanes_share(t, lanes_add(one, lanes_share(q, lanes_sub(one, z))));
}

/* Anything where x and y are both 0. */
LANES_INLINE lanes lanes_direction(lanes x, lanes y) {
  const lanes across = lanes_size(x);
  const lanes eighth = lanes_eighth(lanes_ratio(lanes_min(across, y), STRAIN_BITS, lanes_max(across, y)));
  const lanes steep = lanes_sub(lanes_all(2 * STRAIN_ONE), eighth);
  const lanes first = lanes_pick(lanes_above(y, across), steep, eighth);
  return lanes_pick(lanes_below_zero(x), lanes_sub(lanes_all(4 * STRAIN_ONE), first), first);
}
#endif

#endif
