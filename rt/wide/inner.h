/* SPDX-License-Identifier: Apache-2.0 */
/* Inner steps of triangle sheets: what kernels take (pulls.h, folds.h, steps.h). stage/pull.c, stage/fold.c
 * and stage/inner.c say what is computed. Sums of impulses wrap, so triangles may come in any order. */
#ifndef FRAY_WIDE_INNER_H
#define FRAY_WIDE_INNER_H

#include "rt/model/cloths.h"
#include "rt/model/crease.h"
#include "rt/model/inner.h"
#include "rt/model/sheet.h"

enum { PULL_MORE_BITS = 4, PULL_MAX = (1 << 26) - (1 << 22) }; /* Q26 */
enum { FOLD_MAX = 1 << 20 }; /* Q26 */

typedef struct {
  const inner_place *place;
  inner_sum *sum;
  const sheet_triangle *triangle;
  const sheet_weights *weights;
  const pull_row *row;
} pull_view;

typedef struct {
  const inner_place *place;
  inner_sum *sum;
  const crease *creases;
} fold_view;

/* Triangles once a tick (stresses.h, stage/pull.c). */
typedef struct {
  const int32_t *at[3]; /* vertices, Q24 lu */
  const sheet_triangle *triangle;
  const sheet_weights *weights;
  const fabric *fabrics;
  const uint8_t *cloth;
  unsigned habit_shift;
  int32_t steep;
  habit *habits;
  pull_row *row;
  tensor *stress;
} stress_view;

/* Wind once a tick (blows.h, stage/blow.c). */
typedef struct {
  const int32_t *at[3], *speed[3]; /* vertices, Q24 lu, Q28 lu per substep */
  const sheet_triangle *triangle;
  const cloth_params *cloths;
  inner_sum *sum;
} blow_view;

/* Creases once a tick (weighs.h, stage/crease.c). */
typedef struct {
  const int32_t *at[3]; /* vertices, Q24 lu */
  const int32_t *u, *v; /* at rest */
  const fabric *fabrics;
  const cloth_params *cloths;
  crease *creases;
} weigh_view;

typedef struct {
  inner_place *place;
  const inner_sum *sum;
  int32_t *v[3], *low[3];
  const int32_t *inverse;
  int32_t gravity[3];
  int32_t part;   /* 2^31 / inner */
  int32_t drag;   /* Q30 */
  int32_t dither; /* Q30 of 0..1 */
} inner_view;

#endif
