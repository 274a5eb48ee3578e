/* SPDX-License-Identifier: Apache-2.0 */
/* How much torn cloth frays.
 *
 * A broken spring leaves two yarn ends. The loose end of a yarn reaches from there over all disconnected
 * crossings to where the first that is not stands on it, having slid. `fray` is the length of all loose ends, along the yarns at rest,
 * over the length of the tear: for every broken spring the distance to the next yarn. 0 without yarns.
 *
 * `zone_cm` is the width to which the weave has opened along the tear: the area of the split crossings
 * over its length. It shows how far splitting spreads, whether or not yarns slid off each other. */
#ifndef FRAY_TOOLS_ANALYSIS_FRAYING_H
#define FRAY_TOOLS_ANALYSIS_FRAYING_H

#include "rt/fray.h"

typedef struct {
  uint32_t cuts;                            /* broken springs */
  uint32_t ends;                            /* loose ends of a spacing and more */
  double tear_cm, loose_cm, fray;           /* fray: loose_cm / tear_cm, 0 without a tear */
  double zone_cm;                           /* 0 without a tear */
  uint32_t split, connected, loose, disconnected; /* crossings */
} fraying;

/* Returns 0 iff memory ran out. */
int fraying_measure(const fray_world *world, fraying *out);

#endif
