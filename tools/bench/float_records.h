/* SPDX-License-Identifier: Apache-2.0 */
/* The structural links of a world in float, eight at a time (AVX2 and FMA), batch by batch as the
 * world has them, every end by its id: a loop for any mesh. A particle is a record of 16 bytes, so
 * an end is one load and one store; differences are transposed, positions never are. Rows between
 * held particles and dead ones are left out when it is opened, and a held end is not stored. Like
 * the plain loop it projects in full both ways and does not look for coincident ends. */
#ifndef FRAY_TOOLS_BENCH_FLOAT_RECORDS_H
#define FRAY_TOOLS_BENCH_FLOAT_RECORDS_H

#include <stdint.h>

#include "rt/fray.h"

typedef struct {
  uint32_t first, end; /* whole eights, the last filled up with padding */
  int held;
} float_batch;

typedef struct {
  float *particles; /* x y z 0 */
  uint32_t *i, *j;
  float *reach; /* half the rest length; all of it where end i is held */
  float_batch *batches;
  uint32_t particle_count, batch_count, rows;
} float_records;

int float_avx2_able(void); /* this machine has AVX2 and FMA */

int float_records_open(float_records *f, const fray_world *world);
void float_records_restore(float_records *f, const fray_world *world); /* its positions */
void float_records_iterate(float_records *f);
void float_records_close(float_records *f);

#endif
