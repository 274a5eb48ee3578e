/* SPDX-License-Identifier: Apache-2.0 */
/* How the stress of a triangle sheet becomes motion: gains that the scene compiler worked out, in the
 * units of this world. Derivations stand where they are used, in stage/pull.c and stage/fold.c. */
#ifndef FRAY_MODEL_CLOTHS_H
#define FRAY_MODEL_CLOTHS_H

#include "rt/model/fabric.h"
#include "rt/model/params.h"

enum { LIMIT_INNER = 1024, CLOTH_LOADS = 4, LIMIT_WIND = 1 << 30, LIMIT_LOAD = 1 << 30 };

/* A force on the border of the sheet as far as it lies on the line n.(u, v) = at. */
#define CLOTH_LOAD(X, n) \
  X(load_##n##_u,       -(1 << 30), 1 << 30)      /* Q30: n; both 0: none */ \
  X(load_##n##_v,       -(1 << 30), 1 << 30) \
  X(load_##n##_at,      -(1 << 30), 1 << 30)      /* Q24 lu */ \
  X(load_##n##_x,       -LIMIT_LOAD, LIMIT_LOAD)  /* impulse of one lu in an inner step, Q26 */ \
  X(load_##n##_y,       -LIMIT_LOAD, LIMIT_LOAD) \
  X(load_##n##_z,       -LIMIT_LOAD, LIMIT_LOAD)

/*    name              least       most */
#define CLOTH_PARAMS(X) \
  X(inner,              1,          LIMIT_INNER) /* steps of the stress in a substep */ \
  X(unit,               1 << 8,     1 << 30)     /* Q30 lu^2, as sheet.mass: what particle_mass_ng weighs */ \
  X(pull_gain,          1 << 30,    WORD_MAX)    /* c to impulse, see stage/pull.c */ \
  X(pull_shift,         8,          62) \
  X(habit_shift,        0,          16)          /* c follows the strain in 2^this ticks, twice over */ \
  X(steep,              1 << 10,    WORD_MAX)    /* Q12 of 1 / lu^2: the square of the greatest weight that \
                                                    inner steps of this length can bear */ \
  X(bend_every,         0,          LIMIT_INNER) /* inner steps from bending to bending; 0: none */ \
  X(bend_gain,          0,          WORD_MAX)    /* stiffness to impulse, see stage/fold.c */ \
  X(bend_shift,         1,          62) \
  X(curve_gain,         0,          WORD_MAX)    /* 1 / lu to the curvatures of the table */ \
  X(wind_x,             -LIMIT_WIND, LIMIT_WIND) /* Q28 lu per substep */ \
  X(wind_y,             -LIMIT_WIND, LIMIT_WIND) \
  X(wind_z,             -LIMIT_WIND, LIMIT_WIND) \
  X(wind_normal,        0,          WORD_MAX)    /* pressure to impulse, see stage/blow.c */ \
  X(wind_drag,          0,          WORD_MAX) \
  X(wind_shift,         1,          62) \
  X(limit,              0,          1 << 20)     /* Q16: a side that is longer than so many times its rest \
                                                    length is shortened to it; 0: none is */ \
  CLOTH_LOAD(X, 0) CLOTH_LOAD(X, 1) CLOTH_LOAD(X, 2) CLOTH_LOAD(X, 3)

typedef struct {
  int32_t u, v, at;
  int32_t force[3];
} cloth_load;

typedef struct {
  int32_t inner, unit, pull_gain, pull_shift, habit_shift, steep;
  int32_t bend_every, bend_gain, bend_shift, curve_gain;
  int32_t wind[3], wind_normal, wind_drag, wind_shift;
  int32_t limit;
  cloth_load load[CLOTH_LOADS];
} cloth_params;

enum {
#define X(name, least, most) +1
  CLOTH_PARAM_WORDS = 0 CLOTH_PARAMS(X)
#undef X
};
_Static_assert(sizeof(cloth_params) == 4u * CLOTH_PARAM_WORDS, "cloth_params is a table of words");

#endif
