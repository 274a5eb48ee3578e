/* SPDX-License-Identifier: Apache-2.0 */
/* How much a torn sheet frays.
 *
 * A cut spring has two yarn ends. From each of them on, the crossings at which the yarn has come apart
 * from its partners are loose: its loose end reaches to the first crossing that still holds it. `fray`
 * is the length of all loose ends, along the yarns at rest, over the length of the tear, which is for
 * every cut spring the distance between it and the next yarn. A sheet without yarns has 0.
 *
 * `zone_cm` is how wide the weave has opened along the tear: the area of the split crossings over its
 * length. It says how far splitting spreads, whether or not the yarns slid off each other. */
#ifndef FRAY_TOOLS_LOOSE_ENDS_H
#define FRAY_TOOLS_LOOSE_ENDS_H

#include "rt/fray.h"

typedef struct {
  uint32_t cuts;                            /* springs */
  uint32_t ends;                            /* loose ones, at least one crossing long */
  double tear_cm, loose_cm, fray;           /* fray: loose_cm / tear_cm, 0 without a tear */
  double zone_cm;                           /* 0 without a tear */
  uint32_t split, connected, loose, disconnected; /* crossings */
} loose_ends;

/* Returns 0 iff memory ran out. */
int loose_ends_find(const fray_world *world, loose_ends *out);

#endif
