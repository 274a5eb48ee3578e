/* SPDX-License-Identifier: Apache-2.0 */
/* The stages of a tick, one verb a file. They talk only through the world; rt/run/step.c alone
 * knows their order. */
#ifndef FRAY_STAGE_STAGE_H
#define FRAY_STAGE_STAGE_H

#include "rt/model/world.h"

/* Once a tick, before the substeps. */
void devices_run(fray_world *w, const fray_input *input); /* hands, states, where bodies go */
void damp_run(fray_world *w);                             /* velocities lose their share */
void springs_run(fray_world *w);                          /* bend and shear */
void collide_gather(fray_world *w);                       /* who may touch what in this tick */

/* Each substep. */
void predict_run(fray_world *w, uint32_t substep);
void strain_run(fray_world *w);
void collide_run(fray_world *w);
void finish_run(fray_world *w);

/* Once a tick, in the last substep, between collisions and velocities. */
void tear_run(fray_world *w); /* finds springs over their threshold */
uint32_t tear_worst(const fray_world *w); /* of them, the farthest over: canonical id */
void cut_run(fray_world *w);  /* cuts them and releases what hung on them */

/* Once a tick, at its end. */
void force_run(fray_world *w, int16_t force[FRAY_HANDS][3]);
void report_run(fray_world *w, fray_output *output);

#endif
