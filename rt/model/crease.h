/* SPDX-License-Identifier: Apache-2.0 */
/* A side of two triangles, which resists being folded there: what of it stays as it is in a tick. */
#ifndef FRAY_MODEL_CREASE_H
#define FRAY_MODEL_CREASE_H

#include "rt/model/fabric.h"

enum {
  HINGE_REACH = FX_LU * 16, /* Q28: corners farther apart along an axis count as a lu */
  HINGE_LEAST = 1 << 16     /* Q56: squared areas and sides below that are none */
};

typedef struct {
  uint32_t x[4];      /* vertices: opposite the side in each triangle, then its ends, 3 and 4 */
  int32_t stiff[FABRIC_CURVES]; /* impulse times height over sin(t/2), by curvature: Q34 as in stage/pull.c */
  int32_t reach;      /* curvature over sin(t/2), Q22 of the steps of `stiff` */
  int32_t height[2];  /* of the first two over the side, Q16 of 1 / lu: its inverse */
  int32_t foot[2];    /* Q24: where they stand over it, 0 at its end 4, 1 at its end 3 */
} crease;

/* A triangle has three, and shares each with another. */
typedef struct {
  uint32_t words[3 * sizeof(crease) / 2 / sizeof(uint32_t)];
} crease_share;

#endif
