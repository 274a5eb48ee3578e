/* SPDX-License-Identifier: Apache-2.0 */
/* The structural links of a world in float, eight at a time (AVX2 and FMA), batch by batch, on
 * arrays x, y, z like the world's own. What is known beforehand is used: rows whose ends both lie
 * one behind the other are loaded and stored whole, without ids; the others come by their ids, lane
 * by lane, which is faster than the gather instruction. Rows between held particles and dead ones
 * are left out when it is opened, and a held end is not stored. Like the plain loop it projects in
 * full both ways and does not look for coincident ends. */
#ifndef FRAY_TOOLS_BENCH_FLOAT_ARRAYS_H
#define FRAY_TOOLS_BENCH_FLOAT_ARRAYS_H

#include <stdint.h>

#include "rt/fray.h"

/* Rows of one batch: a run (the ends count up by one from i and j), or rows by their ids. */
typedef struct {
  uint32_t first; /* in `reach`; and in `i` and `j`, where it is no run */
  uint32_t count; /* those by ids are filled up to whole eights with padding */
  uint32_t i, j;
  uint8_t run, held;
} float_piece;

typedef struct {
  float *x, *y, *z;
  uint32_t *i, *j;
  float *reach; /* half the rest length; all of it where end i is held */
  float_piece *pieces;
  uint32_t particles, piece_count;
  uint32_t rows, springs_in_runs;
} float_arrays;

int float_arrays_open(float_arrays *f, const fray_world *world);
void float_arrays_restore(float_arrays *f, const fray_world *world); /* its positions */
void float_arrays_iterate(float_arrays *f);
void float_arrays_close(float_arrays *f);

#endif
