/* SPDX-License-Identifier: Apache-2.0 */
/* Model 2, the membrane: triangle cloth with measured, anisotropic stiffness and strength (Karaoz 2015): the
 * stages of its tick, in their order. A stage NAME_verb() is in NAME.c. */
#ifndef FRAY_MEMBRANE_MEMBRANE_H
#define FRAY_MEMBRANE_MEMBRANE_H

#include "rt/state/world.h"

/* Once a tick, before the substeps. */
void membrane_stress_update(fray_world *w); /* stress of every triangle, at the beginning of the tick */
void membrane_tear_apply(fray_world *w);    /* splits the vertex that exceeds its strength most */
void blade_cut_apply(fray_world *w);        /* sharp edges and points of rigid meshes cut */
void membrane_gains_update(fray_world *w);  /* stiffness times area, inverse masses, bending hinges */
void wind_apply(fray_world *w);             /* loads on the boundary, aerodynamic drag */

/* Each substep. */
void membrane_step_run(fray_world *w, uint32_t substep); /* elastic steps; as particles_advance() */
void edge_limit_apply(fray_world *w);                    /* shortens edges that are far too long */

/* Parts of these. */
void bend_prepare(fray_world *w);       /* of membrane_gains_update(): constants of the hinges */
void membrane_force_add(fray_world *w); /* of an elastic step: impulses of stress */
void bend_force_add(fray_world *w);     /* and of bending */

#if FRAY_ENERGY
/* Impulses of stress and bending, as of an elastic step that begins here: for the energy ledger. Uses the
 * arrays of the steps, which begin anew. */
void membrane_impulses_now(fray_world *w);
#endif

/* Stiffness that triangle t keeps, Q30 of 0..1: less than 1 where a tear or a cut left it too low for the
 * elastic steps. */
int32_t membrane_softening(const fray_world *w, uint32_t t);

#endif
