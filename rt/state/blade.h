/* SPDX-License-Identifier: Apache-2.0 */
/* Blades: sharp points and edges of rigid meshes that cut the membrane (Karaoz 2015, section 3.3). Constants
 * of worlds that are cut, see membrane/blade_cut.c. */
#ifndef FRAY_STATE_BLADE_H
#define FRAY_STATE_BLADE_H

#include <stdint.h>

/* Speed of approach at which a blade cuts a material, Q24 lu a tick, along the line from the blade's nearest
 * point to the cloth's; BLADE_NEVER: that material is not cut. */
enum { BLADE_NEVER = -1, BLADE_SPEED_MAX = 60 << 24, BLADE_CLOTHS = 8 };

typedef struct {
  int32_t tears_max;            /* 1 to MAX_BREAKS a tick */
  int32_t speed[BLADE_CLOTHS]; /* by material */
} blade_params;
enum { BLADE_WORDS = sizeof(blade_params) / 4 };

#endif
