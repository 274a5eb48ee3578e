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
void stress_run(fray_world *w);                           /* of triangles */
void rip_run(fray_world *w);                              /* triangle sheets tear */
void slash_run(fray_world *w);                            /* blades cut them */
void weigh_run(fray_world *w);                            /* what stress makes of their vertices */
void blow_run(fray_world *w);                             /* loads and wind on them */

void selves_begin(fray_world *w); /* before the first substep */
void layers_begin(fray_world *w);

/* Each substep. */
void predict_run(fray_world *w, uint32_t substep);
void stretch_run(fray_world *w); /* in the place of its particles, where yarns have a stiffness */
void inner_run(fray_world *w, uint32_t substep); /* of triangle sheets: predict, with stress and drag */
void strain_run(fray_world *w);
void limit_run(fray_world *w); /* sides of triangles that are far too long */
void slip_run(fray_world *w, uint32_t substep); /* loose couples keep the cloth's thickness apart */
void collide_run(fray_world *w);
void meshes_begin(fray_world *w); /* before predict */
void meshes_run(fray_world *w);   /* rigid meshes against particles and triangles, behind all else that
                                     moves them */
/* The same once more behind what layers_run() did: who goes through a body keeps his place beside it. Returns how
 * many do. */
uint32_t meshes_look(fray_world *w);
void finish_run(fray_world *w);

/* Once a tick, in the last substep, between collisions and velocities. */
void transition_run(fray_world *w); /* what is strained or comes apart wants to be split */
void split_run(fray_world *w);      /* and is */
void tear_run(fray_world *w); /* finds springs over their threshold */
uint32_t tear_worst(const fray_world *w); /* of them, the farthest over: canonical id */
void selves_run(fray_world *w); /* yarns that met on their ways through the tick are kept apart */
void layers_run(fray_world *w); /* triangles that did so */
void cut_run(fray_world *w);  /* cuts them and releases what hung on them */

/* Parts of these stages, for ticks that several workers share (rt/share). Parts in their stage's
 * order do what its run does to the whole. */
void damp_whole(fray_world *w); /* what differs from the sheet's own motion */
void damp_part(fray_world *w, uint32_t first, uint32_t end); /* particles: drag */
void springs_part(fray_world *w, uint32_t b, uint32_t first, uint32_t end); /* rows of batch b */
void predict_begin(fray_world *w, uint32_t substep);                          /* gravity, bodies */
void predict_held(fray_world *w);
void predict_part(fray_world *w, uint32_t first, uint32_t end);    /* particles */
void strain_part(fray_world *w, uint32_t b, uint32_t batches);     /* one sweep of batches [b, batches) */
void collide_part(fray_world *w, uint32_t first, uint32_t end);    /* contacts */
void creases_weigh(fray_world *w); /* bending, as long as a tick */
void pull_triangles(fray_world *w); /* stress, into the sums of an inner step */
void fold_sides(fray_world *w); /* bending, into the sums of an inner step */
void finish_part(fray_world *w, uint32_t first, uint32_t end);     /* particles, then their contacts */
void finish_contacts(fray_world *w, uint32_t first, uint32_t end); /* contacts */
void tear_part(fray_world *w, uint32_t first, uint32_t end);       /* rows */
void report_begin(fray_world *w, fray_output *output); /* then the hash is taken */
void report_end(fray_world *w, uint64_t found, fray_output *output);

/* Once a tick, at its end. */
void force_run(fray_world *w, int16_t force[FRAY_HANDS][3]);
void report_run(fray_world *w, fray_output *output);

#endif
