/* SPDX-License-Identifier: Apache-2.0 */
/* Divides the links of one iteration into blocks, so that several substeps may be computed at once.
 *
 * Links are ordered from the attached particles outwards, and particles are numbered so. A block is a run
 * of link batches with the work on their particles: a particle is advanced before the first block that
 * touches it, and finished (contacts, velocities) after the last one. So block k touches particles
 * finish_end[k-1] to advance_end[k], and with
 *
 *   finish_end[k+1] >= advance_end[k]                                                      (1)
 *
 * blocks k and k+2 share no particle. A tick computes blocks in the order (pass, block), a pass being one
 * iteration of one substep. Two of them that share a particle are the same block or neighbours; so if (p,
 * k) starts after (p, k-1) and (p-1, k+1), all work on a particle keeps its order. */
#ifndef FRAY_WORKERS_BLOCK_PLAN_H
#define FRAY_WORKERS_BLOCK_PLAN_H

#include "rt/state/world.h"

/* A block. Ends are exclusive; a block begins where the one before it ends, block 0 at batch 0 and the first
 * particle that is not attached. */
typedef struct {
  uint32_t batch_end;   /* of its link batches */
  uint32_t advance_end; /* of the particles advanced before it */
  uint32_t finish_end;  /* of the particles finished after it */
} block_plan;

enum { BLOCKS_MAX = 64, BLOCK_SPRINGS_MIN = 64 };

/* Bytes of scratch for block_plan_make(), aligned to 4. Cost: constant. */
size_t block_plan_scratch_bytes(const fray_world *w);

/* Fills blocks[0..BLOCKS_MAX-1] and returns how many there are, at least 1. One block: the links cannot be
 * divided. Cost: linear in the links. */
uint32_t block_plan_make(const fray_world *w, block_plan *blocks, void *scratch);

/* 1 iff the links, as they are now, touch only the particles of their blocks, and (1) holds.
 * Cost: linear in the links. */
int block_plan_holds(const fray_world *w, const block_plan *blocks, uint32_t count);

#endif
