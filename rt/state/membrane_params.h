/* SPDX-License-Identifier: Apache-2.0 */
/* Parameters of the membrane's motion, as the scene compiler computes them in the units of this world.
 * Derivations are where they are used: membrane/membrane_gains.c, bend_folds.c, bend_prepare.c, wind.c. */
#ifndef FRAY_STATE_MEMBRANE_PARAMS_H
#define FRAY_STATE_MEMBRANE_PARAMS_H

#include "rt/state/material.h"
#include "rt/state/params.h"

enum { MAX_ELASTIC_STEPS = 1024, MEMBRANE_LOADS = 4, MAX_WIND = 1 << 30, MAX_LOAD = 1 << 30 };

/* A force on the boundary edges that lie on the line n.(u, v) = at. */
#define MEMBRANE_LOAD(X, n) \
  X(load_##n##_u,       -(1 << 30), 1 << 30)      /* Q30: n; both 0: none */ \
  X(load_##n##_v,       -(1 << 30), 1 << 30) \
  X(load_##n##_at,      -(1 << 30), 1 << 30)      /* Q24 lu */ \
  X(load_##n##_x,       -MAX_LOAD, MAX_LOAD)  /* impulse of one lu in an elastic step, Q26 */ \
  X(load_##n##_y,       -MAX_LOAD, MAX_LOAD) \
  X(load_##n##_z,       -MAX_LOAD, MAX_LOAD)

/*    name              min         max */
#define MEMBRANE_PARAMS(X) \
  X(steps,              1,          MAX_ELASTIC_STEPS) /* elastic steps in a substep */ \
  X(mass_unit,          1 << 8,     1 << 30)     /* Q30 lu^2: trimesh.mass of one particle_mass_ng */ \
  X(force_gain,         1 << 30,    WORD_MAX)    /* c to impulse, see membrane/membrane_gains.c */ \
  X(force_shift,        8,          62) \
  X(smoothing_shift,    0,          16)          /* c follows the strain in 2^this ticks, by two poles */ \
  X(energy_shift,       1,          31)          /* of material_energy() */ \
  X(norm2_max,          1 << 10,    WORD_MAX)    /* Q12 of 1 / lu^2: the largest trimesh_norm2() that \
                                                    elastic steps of this length can bear */ \
  X(bend_every,         0,          MAX_ELASTIC_STEPS) /* elastic steps from bending to bending; 0: none */ \
  X(bend_bits,          13,         74)          /* format of moments: state/bend_plate.h */ \
  X(bend_row_max,       1,          WORD_MAX)    /* R0 of membrane/bend_folds.c */ \
  X(bend_row_shift,     0,          40) \
  X(curve_gain,         0,          WORD_MAX)    /* 1 / lu to the curvatures of the table */ \
  X(wind_x,             -MAX_WIND, MAX_WIND) /* Q28 lu per substep */ \
  X(wind_y,             -MAX_WIND, MAX_WIND) \
  X(wind_z,             -MAX_WIND, MAX_WIND) \
  X(wind_normal,        0,          WORD_MAX)    /* pressure to impulse, see membrane/wind.c */ \
  X(wind_drag,          0,          WORD_MAX) \
  X(wind_shift,         1,          62) \
  X(edge_limit,         0,          1 << 20)     /* Q16: an edge longer than this many times its rest length \
                                                    is shortened to that; 0: none */ \
  MEMBRANE_LOAD(X, 0) MEMBRANE_LOAD(X, 1) MEMBRANE_LOAD(X, 2) MEMBRANE_LOAD(X, 3)

typedef struct {
  int32_t u, v, at;
  int32_t force[3];
} membrane_load;

typedef struct {
  int32_t steps, mass_unit, force_gain, force_shift, smoothing_shift, energy_shift, norm2_max;
  int32_t bend_every, bend_bits, bend_row_max, bend_row_shift, curve_gain;
  int32_t wind[3], wind_normal, wind_drag, wind_shift;
  int32_t edge_limit;
  membrane_load load[MEMBRANE_LOADS];
} membrane_params;

enum {
#define X(name, min, max) +1
  MEMBRANE_PARAM_WORDS = 0 MEMBRANE_PARAMS(X)
#undef X
};
_Static_assert(sizeof(membrane_params) == 4u * MEMBRANE_PARAM_WORDS, "membrane_params is a table of words");

#endif
