/* SPDX-License-Identifier: Apache-2.0 */
/* The arguments of the membrane kernels. Arrays need the alignment of their elements, no more; vertices of
 * a triangle or hinge are valid indices of every vertex array. Impulses are added by wrapping sums, so the
 * order of triangles does not change them. */
#ifndef FRAY_SIMD_MEMBRANE_VIEW_H
#define FRAY_SIMD_MEMBRANE_VIEW_H

#include "rt/state/bend_hinge.h"
#include "rt/state/elastic_step.h"
#include "rt/state/membrane_params.h"
#include "rt/state/trimesh.h"

enum { FORCE_MORE_BITS = 4, FORCE_MAX = (1 << 26) - (1 << 22) }; /* Q26 */
enum { BEND_MAX = 1 << 20 };                                     /* Q26 */

/* simd_membrane_force(), in an elastic step: the SIMD twin of membrane/membrane_force.c. */
typedef struct {
  const elastic_position *place; /* of vertices, Q28 lu: state/elastic_step.h */
  elastic_impulse *sum;          /* of vertices, Q26; added to */
  const trimesh_triangle *triangle;
  const trimesh_weights *weights; /* of triangles: d(u, v) by edges at rest */
  const membrane_gain *gains;     /* of triangles, once a tick: membrane/membrane_gains.c */
} force_view;

/* simd_bend_force(), in an elastic step. */
typedef struct {
  const elastic_position *place;
  elastic_impulse *sum;
  const bend_hinge *hinges; /* of membrane/bend_prepare.c */
} bend_view;

/* simd_membrane_stress(), once a tick. */
typedef struct {
  const int32_t *at[3]; /* vertices by axis, Q24 lu, within +-FX_WORLD_MAX */
  const trimesh_triangle *triangle;
  const trimesh_weights *weights;
  const material_table *materials;
  const uint8_t *material;  /* of triangles: index into materials */
  unsigned smoothing_shift; /* of the low-pass filter: 2^-smoothing_shift a tick, 0 (no filter) to 31 */
  int32_t weight2_max;      /* largest squared weight, upper word: membrane/membrane_gains.c */
  smoothed_strain *smoothed_strains; /* of triangles, Q28; written */
  membrane_gain *gains;              /* of triangles: stiffness; written */
  material_tensor *stress;           /* of triangles; written */
} stress_view;

/* simd_wind(), once a tick. */
typedef struct {
  const int32_t *at[3];    /* vertices by axis, Q24 lu, within +-FX_WORLD_MAX */
  const int32_t *speed[3]; /* Q28 lu per substep, within +-FX_SPEED_MAX */
  const trimesh_triangle *triangle;
  const membrane_params *constants;
  elastic_impulse *sum; /* of vertices, Q26; added to */
} wind_view;

/* simd_bend_prepare(), once a tick. */
typedef struct {
  const int32_t *at[3]; /* vertices by axis, Q24 lu, within +-FX_WORLD_MAX */
  const int32_t *u, *v; /* vertices at rest */
  const material_table *materials;
  const membrane_params *constants;
  bend_hinge *hinges; /* vertices and, in curvature_scale, the index into materials; all else is written */
} hinge_view;

/* simd_membrane_step(): vertices in an elastic step. Arrays have one element for each vertex. */
typedef struct {
  elastic_position *place;    /* written */
  const elastic_impulse *sum; /* Q26 */
  int32_t *v[3];              /* velocities by axis, Q28 lu per substep; written */
  int32_t *low[3];            /* positions below Q28, ELASTIC_LOW_BITS, not negative; written */
  const int32_t *inverse;     /* inverse masses, ELASTIC_INVERSE_BITS */
  int32_t gravity[3];         /* Q28 lu per substep, in this step */
  int32_t part;               /* 2^31 / elastic steps of a substep */
  int32_t drag;               /* Q30 of 0..1 */
  int32_t dither;             /* Q30 of 0..1 */
} step_view;

#endif
