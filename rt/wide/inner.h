/* SPDX-License-Identifier: Apache-2.0 */
/* Inner steps of triangle sheets: what kernels take (pulls.h, folds.h, steps.h). stage/pull.c, stage/fold.c
 * and stage/inner.c say what is computed. Sums of impulses wrap, so triangles may come in any order. */
#ifndef FRAY_WIDE_INNER_H
#define FRAY_WIDE_INNER_H

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
