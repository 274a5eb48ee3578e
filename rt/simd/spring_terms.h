/* SPDX-License-Identifier: Apache-2.0 */
/* What the scalar bend and shear springs (woven/bend_shear.c, with derivation) and their kernel share. */
#ifndef FRAY_SIMD_SPRING_TERMS_H
#define FRAY_SIMD_SPRING_TERMS_H

#include "rt/state/spring.h"

enum {
  BEND_SHEAR_HI_MAX = 16383,
  BEND_SHEAR_T_MIN = 1024, /* 1/32 in Q15 */
  BEND_SHEAR_DV_MAX = 1 << 24 /* one spring, one tick: 1/16 lu per substep */
};

/* The arguments of simd_bend_shear(). */
typedef struct {
  const int32_t *restrict x, *restrict y, *restrict z; /* particles, Q24 lu, within +-FX_WORLD_MAX */
  int32_t *restrict vx, *restrict vy, *restrict vz;    /* Q28 lu per substep; written */
  const index_t *i, *j; /* one for each spring: its ends; springs of a batch share no particle */
  const uint8_t *kind;  /* one for each spring: class and SPRING_ bits, SPRING_DEAD for none */
  const bend_shear_class *classes;
} bend_shear_view;

#endif
