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

/* Passes that a worker takes at a time: in each step a block of each of them, one further back for each
 * pass. So what one has loaded serves the next. */
enum { SHARE_DEPTH_MAX = 8 };

/* The steps of a tick that every worker takes, in their order. The substeps are turns of `turn_steps`
 * steps, or one step where a single worker takes them all. */
typedef struct {
  uint32_t damp, springs, gather, substeps, tear, join, hash, close, end;
} share_steps;

struct fray_share {
  fray_world *world;
  uint32_t workers;
  uint32_t passes;        /* sweeps of a tick */
  uint32_t block_count;   /* 0: the substeps are one worker's */
  uint32_t depth;         /* passes of a turn, 1..SHARE_DEPTH_MAX */
  uint32_t turn_steps;
  share_steps at;
  hash axes[HASHED][3];
  plan_block blocks[PLAN_BLOCKS_MAX];
  uint32_t contact_from[PLAN_BLOCKS_MAX + 1][LIMIT_BODIES]; /* by block and body */
  share_part *parts;      /* `depth` for each worker */
  void *scratch;
};

/* Chooses depth and turn_steps and places the steps, from all before them. */
void share_order(fray_share *s);

/* What a worker does as the n-th thing of a step of the substeps, n < depth. Returns 0: nothing. */
typedef struct {
  uint32_t pass, block;
} share_place;
int share_place_of(const fray_share *s, uint32_t worker, uint32_t step, uint32_t n,
                   share_place *place);

#endif
