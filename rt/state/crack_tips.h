/* SPDX-License-Identifier: Apache-2.0 */
/* Cracks of an isotropic sheet: constants, and the tips that go on. See membrane/crack.c. */
#ifndef FRAY_STATE_CRACK_TIPS_H
#define FRAY_STATE_CRACK_TIPS_H

#include "rt/base/fx.h"
#include "rt/state/params.h"
#include "rt/state/tear_strength.h"

enum { CRACK_TIPS = 32, CRACK_AVERAGE_MAX = 4 * FX_LU };

/*    name              min         max */
#define CRACK_PARAMS(X) \
  X(breaks,             1,          MAX_TEAR_STRENGTH) /* Q12 N/m: principal stress at which it cracks */ \
  X(average,            1 << 10,    CRACK_AVERAGE_MAX) /* Q24 lu at rest: radius of the average */ \
  X(many,               0,          1)                 /* a crack may begin while others have tips */
typedef struct {
  int32_t breaks, average, many;
} crack_params;

/* A tip is a vertex on the boundary, and the way that it came, Q30. Those not in use are 0. */
typedef struct {
  int32_t vertex, way_u, way_v;
} crack_tip;

typedef struct {
  int32_t tips; /* in use */
  crack_tip tip[CRACK_TIPS];
} crack_state;

enum { CRACK_PARAM_WORDS = sizeof(crack_params) / 4, CRACK_STATE_WORDS = sizeof(crack_state) / 4 };

#endif
