/* SPDX-License-Identifier: Apache-2.0 */
/* The same projections in float, as a yardstick: every live structural link of a world, one after
 * the other, on an array of structures. PLAIN takes them in the grid's order, COLOURED in four
 * colours (even and odd links of wefts and warps), so that neighbours do not wait for each other,
 * BATCHED in the world's own order. */
#ifndef FRAY_TOOLS_BENCH_FLOAT_LOOP_H
#define FRAY_TOOLS_BENCH_FLOAT_LOOP_H

#include <stdint.h>

#include "rt/fray.h"

typedef enum { FLOAT_PLAIN, FLOAT_COLOURED, FLOAT_BATCHED } float_order;

typedef struct {
  float x, y, z, weight;
} float_particle;

typedef struct {
  float_particle *particles;
  uint32_t *i, *j;
  float *rest;
  uint32_t rows;
} float_loop;

int float_loop_open(float_loop *f, const fray_world *world, float_order order);
void float_loop_restore(float_loop *f, const fray_world *world); /* its positions */
void float_loop_iterate(float_loop *f);
void float_loop_close(float_loop *f);

#endif
