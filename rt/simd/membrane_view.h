/* SPDX-License-Identifier: Apache-2.0 */
/* The arguments of the membrane kernels. Arrays need the alignment of their elements, no more; vertices of
 * a triangle or fold are valid indices of every vertex array. Impulses are added by wrapping sums, so the
 * order of triangles does not change them. */
#ifndef FRAY_SIMD_MEMBRANE_VIEW_H
#define FRAY_SIMD_MEMBRANE_VIEW_H

#include "rt/state/bend_plate.h"
#include "rt/state/elastic_step.h"
#include "rt/state/membrane_params.h"
#include "rt/state/trimesh.h"

enum { FORCE_MORE_BITS = 4, FORCE_MAX = (1 << 26) - (1 << 22) }; /* Q26 */
/* Damping: stress goes on by 2^-STRESS_RISE_BITS of what it rose by since the last step. */
enum { STRESS_RISE_BITS = 5, STRESS_KEPT_MAX = (1 << 30) - (1 << STRESS_RISE_BITS) };
enum {
  BEND_MAX = 1 << 20,    /* Q26: impulse of a corner */
  BEND_PER_LENGTH_LESS = 26,   /* a moment in Q(bend_bits - 2) over a length in Q20, to Q(bend_bits - 8) */
  BEND_TORQUE_LESS = 24,       /* that times a length in Q28, to Q(bend_bits - 4) */
  BEND_TORQUE_MAX = 1 << 30,
  BEND_IMPULSE_LESS = 28       /* that times a length, over an area of bend_normal, to Q26 */
};
/* 2 asin(s) / s by s^2, Q28: the first two are exact. */
enum {
  BEND_ASIN_0 = 1 << 29, BEND_ASIN_1 = 89478485, BEND_ASIN_2 = 55489574, BEND_ASIN_3 = -49118902,
  BEND_ASIN_4 = 109487913
};

/* simd_membrane_force(), in an elastic step: the SIMD twin of membrane/membrane_force.c. */
typedef struct {
  const elastic_position *place; /* of vertices, Q28 lu: state/elastic_step.h */
  elastic_impulse *sum;          /* of vertices, Q26; added to */
  const trimesh_triangle *triangle;
  const trimesh_weights *weights; /* of triangles: d(u, v) by edges at rest */
  const membrane_gain *gains;     /* of triangles, once a tick: membrane/membrane_gains.c */
  const int32_t *strain_threshold; /* of triangles: membrane/strain_law.h; above it they are left */
  int32_t *last;         /* of triangles: stress of the last step, three columns; written. NULL: no damping */
  uint32_t last_stride;  /* of these columns */
  int32_t has_last;      /* 0: there was none in this tick */
} force_view;

/* simd_bend_normals(), _folds(), _moments(), _joints(), _corners(): in a bending step. */
typedef struct {
  const elastic_position *place;
  elastic_impulse *sum;             /* of vertices, Q26; added to by the last */
  const trimesh_triangle *triangle;
  const int32_t *plates;            /* of triangles: PLATE_COLUMNS, `plate_stride` words apart */
  int32_t *folds;                   /* of folds: FOLD_COLUMNS, `fold_stride` apart; offsets are written */
  bend_normal *normal;              /* of triangles; written by the first */
  bend_moment *moment;              /* of triangles; written: state/bend_plate.h */
  uint32_t plate_stride, fold_stride;
  int32_t impulse_shift;            /* bend_bits - BEND_IMPULSE_LESS */
  int is_measure;                   /* not 0: offsets stay */
} bend_view;
static inline const int32_t *bend_plate(const bend_view *v, uint32_t column) {
  return v->plates + column * v->plate_stride;
}
static inline int32_t *bend_fold(const bend_view *v, uint32_t column) {
  return v->folds + column * v->fold_stride;
}

/* simd_membrane_stress(), once a tick. */
typedef struct {
  const int32_t *at[3]; /* vertices by axis, Q24 lu, within +-FX_WORLD_MAX */
  const trimesh_triangle *triangle;
  const trimesh_weights *weights;
  const material_table *materials;
  const uint8_t *material;  /* of triangles: index into materials */
  unsigned smoothing_shift; /* of the low-pass filter: 2^-smoothing_shift a tick, 0 (no filter) to 31 */
  unsigned energy_shift;    /* of material_energy(), 1 to 31 */
  int32_t norm2_max;        /* the largest trimesh_norm2() that keeps all of its stiffness */
  const int32_t *strain_threshold; /* of triangles: membrane/strain_law.h; above it they are left */
  stiffness_state *stiffness;      /* of triangles; written */
  material_tensor *stress;         /* of triangles; written */
} stress_view;

/* simd_wind(), once a tick. */
typedef struct {
  const int32_t *at[3];    /* vertices by axis, Q24 lu, within +-FX_WORLD_MAX */
  const int32_t *speed[3]; /* Q28 lu per substep, within +-FX_SPEED_MAX */
  const trimesh_triangle *triangle;
  const uint32_t *area; /* of triangles, at rest; below TRIMESH_AREA_MAX */
  const membrane_params *constants;
  elastic_impulse *sum; /* of vertices, Q26; added to */
} wind_view;

/* simd_bend_stiffness(), when it changes, and simd_bend_geometry(), once a tick. */
typedef struct {
  const int32_t *at[3]; /* vertices by axis, Q24 lu, within +-FX_WORLD_MAX */
  const trimesh_triangle *triangle;
  const uint32_t *area;     /* of triangles, Q30 lu^2 */
  const bend_shape *shapes; /* of triangles */
  const uint8_t *material;  /* of triangles: index into materials */
  const material_table *materials;
  const bend_state *states; /* of triangles */
  int32_t *plates;          /* of triangles: PLATE_COLUMNS, `stride` words apart; written */
  uint32_t stride;
} plate_view;

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
