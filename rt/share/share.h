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

/* The steps of a tick that every worker takes, in their order: `own` has some of the far springs too,
 * `far` the others. The substeps are `own_most` steps a pass. */
typedef struct {
  uint32_t own, near, far, gather, substeps, tear, hash, close, end;
} share_steps;

/* Of the springs of a batch a worker has near rows, then own and far ones up to the next worker's. */
typedef struct {
  uint32_t near, own, far;
} share_cut;

enum { SHARE_NO_GATE = 0xFFFFFFFF };

struct fray_share {
  fray_world *world;
  uint32_t workers;
  uint32_t passes;        /* sweeps of a tick */
  uint32_t block_count;   /* 0: the tick is one worker's */
  uint32_t owners;        /* workers that have blocks; they come first */
  uint32_t own_most;      /* blocks of the worker that has most */
  uint32_t from[FRAY_WORKERS_MAX + 1]; /* worker n has blocks from[n] to from[n + 1] - 1 */
  int gathers;            /* there are surfaces: between springs and substeps, who may touch what */
  int springs_first;      /* no substep before all springs */
  uint32_t springs_from[FRAY_WORKERS_MAX + 1]; /* particle: see seams.c */
  uint32_t far_from[FRAY_WORKERS_MAX + 1];
  uint32_t least[FRAY_WORKERS_MAX + 1];
  uint32_t gate[FRAY_WORKERS_MAX]; /* its block that follows the next one's near springs */
  share_steps at;
  hash axes[HASHED][3];
  plan_block blocks[PLAN_BLOCKS_MAX];
  uint32_t contact_from[PLAN_BLOCKS_MAX + 1][LIMIT_BODIES]; /* by block and body */
  share_part *parts;      /* one for each worker */
  share_cut *cuts;        /* by batch of springs and worker, one more worker than there is */
  void *scratch;
};

/* Divides the blocks and the springs and places the steps, from all before them. */
void share_order(fray_share *s);
/* Rows of the links before a block. */
uint32_t share_rows_before(const fray_share *s, uint32_t block);
/* The springs, from how the blocks are divided. */
void seams_cut(fray_share *s);
/* 1 iff the springs as they are now touch only what they may. */
int seams_hold(const fray_share *s);

/* What a worker does in a step of the substeps. Returns 0: nothing. */
typedef struct {
  uint32_t pass, block;
} share_place;
int share_place_of(const fray_share *s, uint32_t worker, uint32_t step, share_place *place);

#endif
