/* SPDX-License-Identifier: Apache-2.0 */
/* Model 2, the membrane: triangle cloth with measured, anisotropic stiffness and strength (Karaoz 2015): the
 * stages of its tick, in their order. A stage NAME_verb() is in NAME.c. */
#ifndef FRAY_MEMBRANE_MEMBRANE_H
#define FRAY_MEMBRANE_MEMBRANE_H

#include "rt/elastic/step_impulse.h"
#include "rt/simd/membrane_view.h"

/* Once a tick, before the substeps. */
void membrane_stress_update(fray_world *w); /* stress of every triangle, at the beginning of the tick */
void membrane_stress_find(fray_world *w, uint32_t first, uint32_t end); /* of some of them */
void membrane_tear_apply(fray_world *w);    /* splits the vertex that exceeds its strength most */
#if FRAY_CRACKS
void crack_advance(fray_world *w);          /* for both: tips of an isotropic sheet go on, one begins */
#else
static inline void crack_advance(fray_world *w) { (void)w; }
#endif
void blade_cut_apply(fray_world *w);        /* sharp edges and points of rigid meshes cut */
void membrane_gains_update(fray_world *w);  /* stiffness times area, inverse masses, bending */
void wind_apply(fray_world *w);             /* loads on the boundary, aerodynamic drag */

/* Elastic steps, in tick/elastic_steps.c: their beginning; the forces of step `number` of a substep; behind
 * the constraints on these the motion of free vertices; their end, as particles_advance() leaves them. */
step_view membrane_step_begin(fray_world *w);
elastic_step membrane_step_force(fray_world *w, step_view *view, uint32_t substep, int32_t number);
void membrane_step_move(fray_world *w, const step_view *view);
void membrane_step_end(fray_world *w);
/* Edges that are nearly as long, or as fast, as they may be: once a substep. */
void edge_limits_find(fray_world *w);
typedef enum { EDGE_LENGTH, EDGE_RATE } edge_limit;
/* In each step: before contact the lengths, behind it the rates. */
void edge_limits_solve(fray_world *w, const elastic_step *step, edge_limit limit);
void stretch_repay(fray_world *w, const elastic_step *step); /* in the first elastic step of a tick */
void bend_repay(fray_world *w, const elastic_step *step);

/* Parts of these. */
void bend_prepare(fray_world *w);       /* of membrane_gains_update(): constants of bending */
/* Of an elastic step: impulses of stress. FORCE_FIRST is the first step of a tick, FORCE_MEASURED leaves out
 * damping and keeps nothing. */
typedef enum { FORCE_STEP, FORCE_FIRST, FORCE_MEASURED } force_step_kind;
void membrane_force_add(fray_world *w, force_step_kind kind);
/* And of bending: BEND_LAST is the last step of a tick, which the state follows; BEND_MEASURED leaves all
 * state as it is. */
typedef enum { BEND_STEP, BEND_LAST, BEND_MEASURED } bend_step_kind;
void bend_force_add(fray_world *w, bend_step_kind kind);
uint32_t bend_folds_find(fray_world *w); /* folds of the mesh; returns the largest row, see bend_folds.c */
plate_view bend_plate_view(const fray_world *w);
/* In a bending step, Q28. */
static inline vec3 bend_edge(const elastic_position *place, uint32_t from, uint32_t to) {
  return vec_clamp_rare(vec_wrap_sub(vec_of(place[to].at), vec_of(place[from].at)), BEND_REACH);
}
/* What is left of a triangle, Q30, by |N|^2 in Q56, not below BEND_FLAT, and its sides in Q28. */
int32_t bend_fade_of(const plate_view *view, uint32_t t, uint64_t squared, const uint32_t length[3]);
void bend_fade_begin(fray_world *w);         /* where folds or the state are others */
void bend_fade_follow(fray_world *w);        /* once a tick */
void bend_press(fray_world *w, uint32_t t);  /* in a bending step; then */
void bend_folds_hold(fray_world *w);
void bend_stiffen(fray_world *w, uint32_t first, uint32_t end); /* H of these triangles, by their habits */
/* Habits and H of an eighth of the triangles, behind membrane_angles_find() or in a bending step; and its H
 * once more, where a tick is attempted again. */
void bend_follow(fray_world *w);
void bend_follow_again(fray_world *w);
/* Before and behind a change of stiffness; each behind angles are found. */
void bend_owed_begin(fray_world *w, uint32_t first, uint32_t end);
void bend_owed_end(fray_world *w, uint32_t first, uint32_t end);
/* Angles of all triangles' sides in membrane.moments, as of a step that begins here. */
void membrane_angles_find(fray_world *w);
void bend_angles_find(fray_world *w); /* a part of it */
void bend_offsets_store(fray_world *w); /* to the state, and back */
void bend_offsets_load(fray_world *w);

#if FRAY_ENERGY
/* Impulses of stress and bending, as of an elastic step that begins here: for the energy ledger. Uses the
 * arrays of the steps, which begin anew. */
void membrane_impulses_now(fray_world *w);
#endif

/* From stiffness to gain, by the triangle's area. */
int32_t membrane_gain_of(const fray_world *w, uint32_t t);
/* strain_law_threshold() of a triangle with this stiffness, Q12 N/m. */
int32_t membrane_threshold_of(const fray_world *w, uint32_t t, const int32_t stiffness[MATERIAL_ENTRIES]);

/* Stiffness that a triangle keeps, Q30 of 0..1: less than 1 where a tear or a cut left it too low for the
 * elastic steps. */
int32_t membrane_softening_of(const fray_world *w, const trimesh_weights *weights);
static inline int32_t membrane_softening(const fray_world *w, uint32_t t) {
  FRAY_ASSERT(t < triangles_in_use(w));
  return membrane_softening_of(w, &w->trimesh.weights[t]);
}

#endif
