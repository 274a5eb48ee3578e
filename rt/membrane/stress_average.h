/* SPDX-License-Identifier: Apache-2.0 */
/* The stress around a vertex, averaged over a length of the material: so what a crack needs, and where it
 * goes, depend on that length and not on the mesh. */
#ifndef FRAY_MEMBRANE_STRESS_AVERAGE_H
#define FRAY_MEMBRANE_STRESS_AVERAGE_H

#include "rt/base/sym2.h"
#include "rt/state/world.h"

enum { STRESS_AVERAGE_TRIANGLES = 256, STRESS_AVERAGE_MAX = 1 << 26 /* Q12 N/m: entries are held to it */ };

static inline int32_t stress_average_held(int64_t stress) {
  return (int32_t)fx_clamp64(stress, -STRESS_AVERAGE_MAX, STRESS_AVERAGE_MAX);
}

/* Once a tick, before the first average: the stress of all triangles is known, or each is found when an
 * average has it first. Cost: linear in triangles. */
void stress_average_begin(fray_world *w, int is_known);

/* Of triangles whose middle is within `radius` of the vertex at rest, Q24 lu, and that hang together with it
 * there: weighed by area and (1 - r^2)^2, r the distance over the radius. Q12 N/m. The first
 * STRESS_AVERAGE_TRIANGLES count, from the vertex outward. Cost: linear in these. */
sym2 stress_average(fray_world *w, uint32_t vertex, int32_t radius);

#endif
