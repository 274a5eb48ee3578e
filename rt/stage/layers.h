/* SPDX-License-Identifier: Apache-2.0 */
/* Parts of the stage that keeps triangles from passing through each other; stage/layers.c says how. */
#ifndef FRAY_STAGE_LAYERS_H
#define FRAY_STAGE_LAYERS_H

#include "rt/base/sweep.h"
#include "rt/stage/zones.h"

/* How far all has gone since the tick before. */
void layers_went(fray_world *w);
/* Fills w->layers_met with all pairs that may come within the thickness of each other while every vertex ends
 * within the slack of its way; what has no room is joined. Returns 0 iff something goes farther than can be known. */
int layers_find(fray_world *w);

/* The two of a pair, first and second: where they began and are now. */
typedef struct {
  sweep_point way[4];
} layer_meeting;
layer_meeting layers_meeting(const fray_world *w, const layer_pair *pair);
/* How far they are from each other, at least, when the tick begins and along that direction when it ends. */
sweep_gap layers_gap(const fray_world *w, const layer_pair *pair);

/* As selves_push() and selves_touch(). */
int layers_push(fray_world *w, layer_pair *pair);
int layers_touch(fray_world *w, layer_pair *pair);

void layers_join(fray_world *w, const layer_pair *pair);

#endif
