/* SPDX-License-Identifier: Apache-2.0 */
/* How the ticks of one world are divided among workers: what parallel.c (the steps of a tick), schedule.c
 * (which worker does what, in which step) and spring_partition.c (bend and shear springs) share. */
#ifndef FRAY_WORKERS_PARALLEL_H
#define FRAY_WORKERS_PARALLEL_H

#include "rt/base/hash.h"
#include "rt/contact/contact.h"
#include "rt/haptics/haptics.h"
#include "rt/image/state_hash.h"
#include "rt/integrate/integrate.h"
#include "rt/tick/tick.h"
#include "rt/woven/woven.h"
#include "rt/workers/block_plan.h"

enum { PARALLEL_LINE = 64 }; /* bytes of a cache line */

/* The world as one worker sees it: particles, springs and contacts are shared; bodies, faults, the tear queue
 * and the work counts are its own until the end of the tick. */
typedef struct {
  _Alignas(PARALLEL_LINE) fray_world world;
  state state;
  body_state bodies[MAX_BODIES];
  body_motion motion[MAX_BODIES];
  torn_spring tear_queue[MAX_BREAKS];
} parallel_view;

/* The numbers of a tick's steps, the same for every worker, in their order: springs (`own` with the far bend
 * springs, `near`, `far` with the far shear springs), contacts, substeps, tear test, hash. Substeps take
 * steps_per_pass steps a pass. */
typedef struct {
  uint32_t own, near, far, gather, substeps, tear, hash, close, end;
} parallel_steps;

/* The springs of a batch that a worker has: near ones, then own, then far ones up to the next worker's
 * near. */
typedef struct {
  uint32_t near, own, far;
} spring_span;

enum { PARALLEL_NO_GATE = 0xFFFFFFFF };

struct fray_parallel {
  fray_world *world;
  uint32_t workers;
  uint32_t passes;         /* iterations of a tick */
  uint32_t block_count;    /* 0: worker 0 computes the tick alone */
  uint32_t owners;         /* workers 0..owners-1 have blocks */
  uint32_t steps_per_pass; /* the largest number of blocks of a worker */
  uint32_t block_from[FRAY_WORKERS_MAX + 1]; /* worker n has blocks block_from[n]..block_from[n + 1] - 1 */
  int gathers;             /* 1: bodies have surfaces or move; contacts are gathered after the springs */
  int springs_first;       /* 1: no substep begins before all springs are done */
  /* particles, by worker; see spring_partition.c */
  uint32_t spring_from[FRAY_WORKERS_MAX + 1];
  uint32_t far_from[FRAY_WORKERS_MAX + 1];
  uint32_t lowest[FRAY_WORKERS_MAX + 1];
  uint32_t gate_block[FRAY_WORKERS_MAX]; /* its block that waits for the next worker's near springs */
  parallel_steps step;
  hash axis_hash[HASHED][3];
  block_plan blocks[BLOCKS_MAX];
  uint32_t contact_from[BLOCKS_MAX + 1][MAX_BODIES]; /* by block and body */
  parallel_view *views;    /* by worker */
  spring_span *spans;      /* by batch of springs and worker, with one more worker at the end */
  void *scratch;
};

/* Distributes blocks and springs and numbers the steps: world, workers, passes, gathers, block_count and
 * blocks are set. Cost: linear in the springs. */
void schedule_make(fray_parallel *par);
/* The number of links before a block. block <= block_count. Cost: constant. */
uint32_t schedule_springs_before(const fray_parallel *par, uint32_t block);

/* A worker's entry in a step of the substeps. */
typedef struct {
  uint32_t pass, block;
} schedule_entry;
/* worker < workers, step.substeps <= step < step.tear. Returns 0 iff the worker has nothing to do. Cost:
 * constant. */
int schedule_entry_at(const fray_parallel *par, uint32_t worker, uint32_t step, schedule_entry *entry);

/* Distributes the springs: owners and block_from are set, blocks are not yet joined. Cost: linear in the
 * springs that are not links. */
void spring_partition_make(fray_parallel *par);
/* 1 iff the springs, as they are now, touch only the particles that their workers may. Cost: the same. */
int spring_partition_holds(const fray_parallel *par);

#endif
