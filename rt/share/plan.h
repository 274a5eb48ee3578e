/* SPDX-License-Identifier: Apache-2.0 */
/* How the rows of one sweep are cut into blocks, so that several substeps may be under way at once.
 *
 * Links are ordered from the held particles outwards, and particles are numbered so. A block is a
 * run of link batches with all that its particles need around them: they are predicted when the first
 * block touches them, and finished (contacts, velocities) when the last one has. So block k touches
 * particles finish_end[k-1] to predict_end[k], and with
 *
 *   finish_end[k+1] >= predict_end[k]                                                      (1)
 *
 * blocks k and k+2 share no particle. A tick takes blocks in the order (pass, block), a pass being one
 * sweep of one substep. Two of them that share a particle are of the same or of neighbouring blocks;
 * so whoever starts (p, k) after (p, k-1) and (p-1, k+1) keeps the order of everything that meets. */
#ifndef FRAY_SHARE_PLAN_H
#define FRAY_SHARE_PLAN_H

#include "rt/model/world.h"

typedef struct {
  uint32_t batch_end;   /* link batches before it are of this block or of earlier ones */
  uint32_t predict_end; /* particles */
  uint32_t finish_end;
} plan_block;

enum { PLAN_BLOCKS_MAX = 64, PLAN_ROWS_LEAST = 64 };

/* Bytes of scratch that plan_cut() takes. */
size_t plan_scratch_bytes(const fray_world *w);

/* Cuts a sweep; returns how many blocks there are, at most PLAN_BLOCKS_MAX. One: its rows leave no
 * place to cut. Cost: linear in the structural rows. */
uint32_t plan_cut(const fray_world *w, plan_block *blocks, void *scratch);

/* 1 iff the rows as they are now touch only what their blocks may, and (1) holds.
 * Cost: linear in the structural rows. */
int plan_holds(const fray_world *w, const plan_block *blocks, uint32_t count);

#endif
