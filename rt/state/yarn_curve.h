/* SPDX-License-Identifier: Apache-2.0 */
/* Yarns as curves: the quadratic B-spline of a yarn's particles, and a straight line on the outer half of
 * the last link before an end or a break, and a quarter of a spacing beyond it. With the particle k that is
 * nearest to a place u, s = u - k in +-1/2, and neighbours a before and b behind it,
 *
 *   x(u)   weights (1/2 - s)^2 / 2 of a, 3/4 - s^2 of k, (1/2 + s)^2 / 2 of b
 *   x'(u)  (1/2 - s) (k - a) + (1/2 + s) (b - k)
 *
 * Every call has constant cost. */
#ifndef FRAY_STATE_YARN_CURVE_H
#define FRAY_STATE_YARN_CURVE_H

#include "rt/state/world.h"

/* A yarn: its crossings and links are first + k stride. */
typedef struct {
  const index_t *particle; /* by crossing */
  uint32_t crossing, stride;
  uint32_t link, link_stride; /* canonical */
  uint32_t last; /* k of its last particle */
} yarn_line;

/* axis: a fray_axis; number: below the warps, or the wefts. */
yarn_line yarn_line_of(const fray_world *w, uint32_t axis, uint32_t number);
/* 1 iff the link from k to k + 1 is not broken; k < last. */
int yarn_line_holds(const fray_world *w, const yarn_line *line, uint32_t k);

enum { YARN_GOES_BACK = 1, YARN_GOES_ON = 2 };

/* Where a yarn is at a place. */
typedef struct {
  uint32_t nearest;     /* k */
  uint32_t goes;        /* YARN_GOES_BACK and YARN_GOES_ON: its links at k are not broken */
  uint32_t particle[3]; /* a, k, b */
  int32_t weight[2];    /* Q20, of a and b; k has the rest. Below 0 beyond an end */
  int32_t on_share;     /* Q20, of the link on in x' */
  vec3 at, along;       /* x(u), and x'(u) for a spacing: Q24 lu */
} yarn_spot;

/* The particle nearest to `place` is one of the yarn. Returns 0, without a spot, where the yarn has no link
 * left there. */
int yarn_spot_at(const fray_world *w, const yarn_line *line, uint32_t place, yarn_spot *spot);
/* The same without `at` and `along`. */
int yarn_spot_find(const fray_world *w, const yarn_line *line, uint32_t place, yarn_spot *spot);

#endif
