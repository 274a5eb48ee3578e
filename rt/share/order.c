/* SPDX-License-Identifier: Apache-2.0 */
/* Which worker takes what, in which step, and whom it waits for. */
#include "rt/share/share.h"

static uint32_t turns_of(const fray_share *s, uint32_t depth) {
  return (s->passes + depth - 1u) / depth;
}
/* Turns of the worker that has most. */
static uint32_t rounds_of(const fray_share *s, uint32_t depth) {
  return (turns_of(s, depth) + s->workers - 1u) / s->workers;
}

/* In quarters of a block's time: the blocks of the worker that has most; the last worker's wait for
 * the first block; and the particles that come from another worker's cache, once a turn. */
static uint32_t cost_of(const fray_share *s, uint32_t depth) {
  const uint32_t rounds = rounds_of(s, depth);
  const uint32_t all = (rounds - 1u) * s->workers * depth;
  const uint32_t last = s->passes - all < depth ? s->passes - all : depth;
  return 4u * ((rounds - 1u) * depth + last) * s->block_count +
         2u * (s->workers - 1u) * depth * (depth + 3u) + rounds * s->block_count;
}

static uint32_t choose_depth(const fray_share *s) {
  uint32_t best = 1;
  for (uint32_t depth = 2; depth <= SHARE_DEPTH_MAX; ++depth)
    if ((depth + 1u) * s->workers <= s->block_count && cost_of(s, depth) < cost_of(s, best))
      best = depth;
  return best;
}

static share_steps place_steps(const fray_share *s) {
  share_steps at;
  const params *p = s->world->params;
  at.damp = 1;
  at.springs = at.damp + 1u;
  at.gather = at.springs + (uint32_t)(p->bend_batches + p->shear_batches);
  at.substeps = at.gather + 1u;
  at.tear = at.substeps + (s->block_count != 0 ? rounds_of(s, s->depth) * s->turn_steps : 1u);
  at.join = at.tear + 1u;
  at.hash = at.join + 1u;
  at.close = at.hash + 1u;
  at.end = at.close + 1u;
  return at;
}

void share_order(fray_share *s) {
  s->depth = s->block_count != 0 ? choose_depth(s) : 1u;
  s->turn_steps = s->block_count + s->depth - 1u;
  s->at = place_steps(s);
}

uint32_t fray_share_steps(const fray_share *s) { return s->at.end; }

/* Everybody must have come to this step. */
static fray_need need_all(uint32_t step) {
  const fray_need need = {FRAY_EVERYONE, step};
  return need;
}

/* The turn that a worker has in a step of the substeps. */
static uint32_t turn_of(const fray_share *s, uint32_t worker, uint32_t step) {
  return (step - s->at.substeps) / s->turn_steps * s->workers + worker;
}

int share_place_of(const fray_share *s, uint32_t worker, uint32_t step, uint32_t n,
                   share_place *place) {
  const uint32_t in_turn = (step - s->at.substeps) % s->turn_steps;
  place->pass = turn_of(s, worker, step) * s->depth + n;
  place->block = in_turn < n ? s->block_count : in_turn - n;
  return place->pass < s->passes && place->block < s->block_count;
}

/* The last pass of the turn before must be one block further on than the first of this one. */
static fray_need need_of_turn(const fray_share *s, uint32_t worker, uint32_t step) {
  const uint32_t block = (step - s->at.substeps) % s->turn_steps;
  const uint32_t turn = turn_of(s, worker, step);
  fray_need need = {FRAY_EVERYONE, 0};
  if (turn * s->depth >= s->passes || block >= s->block_count) return need;
  if (turn == 0) return block == 0 ? need_all(step) : need;
  const uint32_t next = block + 1u < s->block_count ? block + 1u : block;
  need.worker = (turn - 1u) % s->workers;
  need.steps = s->at.substeps + (turn - 1u) / s->workers * s->turn_steps + next + s->depth;
  return need;
}

fray_need fray_share_need(const fray_share *s, uint32_t worker, uint32_t step) {
  const int divided = (step >= s->at.damp && step < s->at.gather) || step == s->at.tear ||
                      step == s->at.hash;
  if (s->block_count != 0 && step >= s->at.substeps && step < s->at.tear)
    return need_of_turn(s, worker, step);
  return divided || worker == 0 ? need_all(step) : need_all(0);
}
