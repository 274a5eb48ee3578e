/* SPDX-License-Identifier: Apache-2.0 */
/* A share: how the ticks of one world are divided. */
#ifndef FRAY_SHARE_SHARE_H
#define FRAY_SHARE_SHARE_H

#include "rt/base/hash.h"
#include "rt/share/plan.h"
#include "rt/stage/stage.h"

enum { SHARE_LINE = 64 };

/* The world as one worker sees it: particles, rows and contacts are everybody's; bodies, flags, the
 * list of cuts and what is counted are its own until they are joined. */
typedef struct {
  _Alignas(SHARE_LINE) fray_world world;
  state state;
  body_state bodies[LIMIT_BODIES];
  body_motion motion[LIMIT_BODIES];
  cut cuts[LIMIT_CUTS];
} share_part;

/* The steps of a tick that every worker takes, in their order. The substeps are `own_most` steps a pass,
 * or one step where a single worker takes them all. */
typedef struct {
  uint32_t damp, springs, gather, substeps, tear, join, hash, close, end;
} share_steps;

struct fray_share {
  fray_world *world;
  uint32_t workers;
  uint32_t passes;        /* sweeps of a tick */
  uint32_t block_count;   /* 0: the substeps are one worker's */
  uint32_t own_most;      /* blocks of the worker that has most */
  uint32_t from[FRAY_WORKERS_MAX + 1]; /* worker n has blocks from[n] to from[n + 1] - 1 */
  uint32_t part[FRAY_WORKERS_MAX + 1]; /* Q16: where its particles begin among all */
  share_steps at;
  hash axes[HASHED][3];
  plan_block blocks[PLAN_BLOCKS_MAX];
  uint32_t contact_from[PLAN_BLOCKS_MAX + 1][LIMIT_BODIES]; /* by block and body */
  share_part *parts;      /* one for each worker */
  void *scratch;
};

/* Divides the blocks and places the steps, from all before them. */
void share_order(fray_share *s);

/* What a worker does in a step of the substeps. Returns 0: nothing. */
typedef struct {
  uint32_t pass, block;
} share_place;
int share_place_of(const fray_share *s, uint32_t worker, uint32_t step, share_place *place);

#endif
