/* SPDX-License-Identifier: Apache-2.0 */
/* What sharp points and edges of rigid meshes do to a triangle sheet (Karaoz 2015, section 3.3): constants of
 * worlds that are cut, see stage/slash.c. */
#ifndef FRAY_MODEL_BLADES_H
#define FRAY_MODEL_BLADES_H

#include <stdint.h>

/* How fast a blade comes at cloth that it cuts, Q24 lu a tick, along the way from the blade's nearest point to
 * the cloth's; BLADE_NEVER: that cloth is not cut. */
enum { BLADE_NEVER = -1, BLADE_SPEED_MAX = 60 << 24, BLADE_CLOTHS = 8 };

typedef struct {
  int32_t cuts_max;            /* 1 to LIMIT_CUTS a tick */
  int32_t speed[BLADE_CLOTHS]; /* by cloth */
} blade_params;
enum { BLADE_WORDS = sizeof(blade_params) / 4 };

#endif
