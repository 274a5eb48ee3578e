/* SPDX-License-Identifier: Apache-2.0 */
/* What the scalar bend and shear springs (stage/springs.c, which says what they compute) and the
 * wide ones share. */
#ifndef FRAY_WIDE_SPRING_H
#define FRAY_WIDE_SPRING_H

#include "rt/model/rows.h"

enum {
  SPRING_HI_MAX = 16383,
  SPRING_T_LEAST = 1024, /* 1/32 in Q15 */
  SPRING_DV_MAX = 1 << 24, /* one spring, one tick: 1/16 lu per substep */
  /* 1 - 1/sqrt(1 + x) on x = -1/2..1, in powers of x from the first, Q14 */
  SPRING_SERIES_1 = 8192,
  SPRING_SERIES_2 = -6780,
  SPRING_SERIES_3 = 6059,
  SPRING_SERIES_4 = -2706
};

typedef struct {
  const int32_t *restrict x, *restrict y, *restrict z;
  int32_t *restrict vx, *restrict vy, *restrict vz;
  const row_id *i, *j;
  const uint8_t *kind;
  const spring_class *classes;
} spring_view;

#endif
