/* SPDX-License-Identifier: Apache-2.0 */
/* The hash of a world's state: what every tick reports and every recording carries. */
#ifndef FRAY_IMAGE_STATE_HASH_H
#define FRAY_IMAGE_STATE_HASH_H

#include "rt/base/hash.h"
#include "rt/state/world.h"

/* The state's hash; cost: 9 words a particle. */
uint64_t state_hash(const fray_world *w);
/* Its pieces, which several workers can take: all but the particles; then, joined to it in this order,
 * the axes of each of the particles' arrays. These go from particle to particle: parts begin at a
 * multiple of HASH_LANES, where the part before has ended. */
typedef enum { HASHED_POSITIONS, HASHED_VELOCITIES, HASHED_REMAINDERS, HASHED } state_hash_part;
void state_hash_begin(const fray_world *w, hash *h);
void state_hash_axes(const fray_world *w, state_hash_part which, hash axes[3], uint32_t first,
                     uint32_t end);

#endif
