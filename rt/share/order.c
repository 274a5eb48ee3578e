/* SPDX-License-Identifier: Apache-2.0 */
/* Which worker takes what, in which step, and whom it waits for. */
#include "rt/share/share.h"

static uint32_t rows_before(const fray_share *s, uint32_t block) {
  if (block == 0) return 0;
  const row_batch *last = &s->world->batches[s->blocks[block - 1u].batch_end - 1u];
  return (uint32_t)(last->first + last->count);
}

/* A worker begins a pass when the one before it has come to its end of it, so the last one begins late.
 * With (passes - 1) / passes of what the one before has, all end at once. Two blocks at least: whoever
 * begins one must not be waited for at its end. */
static void divide(fray_share *s) {
  const uint32_t owners = s->block_count / 2u < s->workers ? s->block_count / 2u : s->workers;
  uint64_t share[FRAY_WORKERS_MAX];
  uint64_t all = 0;
  for (uint32_t n = 0; n < owners; ++n) {
    share[n] = n == 0 ? (uint64_t)1 << 16 : share[n - 1u] * (s->passes - 1u) / s->passes;
    all += share[n];
  }
  uint64_t before = 0;
  for (uint32_t n = 0; n < s->workers; ++n) {
    const uint32_t left = n < owners ? 2u * (owners - 1u - n) : 0; /* blocks for those behind */
    uint32_t end = s->from[n];
    if (n < owners) before += share[n];
    while (n < owners && end < s->block_count - left &&
           (end < s->from[n] + 2u || n + 1u == owners ||
            (uint64_t)rows_before(s, end) * all < before * rows_before(s, s->block_count)))
      ++end;
    s->from[n + 1u] = end;
  }
}

/* Only the ends of what a worker has meet others: what lies between them becomes one block. */
static void join_middles(fray_share *s) {
  uint32_t count = 0;
  s->own_most = 0;
  for (uint32_t n = 0; n < s->workers; ++n) {
    const uint32_t first = s->from[n];
    const uint32_t end = s->from[n + 1u];
    s->from[n] = count;
    for (uint32_t k = first; k < end; ++k)
      if (k == first || k + 2u >= end) s->blocks[count++] = s->blocks[k];
    if (count - s->from[n] > s->own_most) s->own_most = count - s->from[n];
  }
  s->from[s->workers] = count;
  s->block_count = count;
}

static share_steps place_steps(const fray_share *s) {
  share_steps at;
  const params *p = s->world->params;
  at.damp = 1;
  at.springs = at.damp + 1u;
  at.gather = at.springs + (uint32_t)(p->bend_batches + p->shear_batches);
  at.substeps = at.gather + 1u;
  at.tear = at.substeps + (s->block_count != 0 ? s->passes * s->own_most : 1u);
  at.join = at.tear + 1u;
  at.hash = at.join + 1u;
  at.close = at.hash + 1u;
  at.end = at.close + 1u;
  return at;
}

/* By the blocks, or evenly where one worker takes them all. */
static void find_parts(fray_share *s) {
  const uint32_t held = (uint32_t)s->world->params->held;
  const uint64_t all = (uint64_t)(uint32_t)s->world->params->particles - held;
  for (uint32_t n = 0; n <= s->workers; ++n) {
    s->part[n] = (n << 16) / s->workers;
    if (s->block_count == 0 || n == 0 || all == 0) continue;
    s->part[n] =
        s->from[n] == 0 ? 0
                        : (uint32_t)(((uint64_t)(s->blocks[s->from[n] - 1u].finish_end - held) << 16) / all);
  }
}

void share_order(fray_share *s) {
  if (s->block_count != 0) {
    divide(s);
    join_middles(s);
  }
  find_parts(s);
  s->at = place_steps(s);
}

uint32_t fray_share_steps(const fray_share *s) { return s->at.end; }

/* Everybody must have come to this step. */
static fray_need need_all(uint32_t step) {
  const fray_need need = {FRAY_EVERYONE, step};
  return need;
}

int share_place_of(const fray_share *s, uint32_t worker, uint32_t step, share_place *place) {
  const uint32_t n = step - s->at.substeps;
  place->pass = n / s->own_most;
  place->block = s->from[worker] + n % s->own_most;
  return place->block < s->from[worker + 1u];
}

/* The steps that a worker has done once it has taken a block in a pass. */
static uint32_t steps_until(const fray_share *s, uint32_t worker, uint32_t pass, uint32_t block) {
  return s->at.substeps + pass * s->own_most + (block - s->from[worker]) + 1u;
}

/* Before (pass, block) come (pass, block - 1) and (pass - 1, block + 1), which a neighbour may have. */
static fray_need need_of_block(const fray_share *s, uint32_t worker, uint32_t step) {
  fray_need need = {FRAY_EVERYONE, 0};
  share_place at;
  if (!share_place_of(s, worker, step, &at)) return need;
  if (at.block == 0) return at.pass == 0 ? need_all(step) : need;
  if (at.block == s->from[worker]) {
    need.worker = worker - 1u;
    need.steps = steps_until(s, worker - 1u, at.pass, at.block - 1u);
  } else if (at.pass != 0 && at.block + 1u == s->from[worker + 1u] &&
             at.block + 1u < s->block_count) {
    need.worker = worker + 1u;
    need.steps = steps_until(s, worker + 1u, at.pass - 1u, at.block + 1u);
  }
  return need;
}

fray_need fray_share_need(const fray_share *s, uint32_t worker, uint32_t step) {
  const int divided = (step >= s->at.damp && step < s->at.gather) || step == s->at.tear ||
                      step == s->at.hash;
  if (s->block_count != 0 && step >= s->at.substeps && step < s->at.tear)
    return need_of_block(s, worker, step);
  return divided || worker == 0 ? need_all(step) : need_all(0);
}
