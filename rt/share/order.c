/* SPDX-License-Identifier: Apache-2.0 */
/* Which worker takes what, in which step, and whom it waits for. */
#include "rt/share/share.h"

/* Into how many blocks the last worker's middle is cut. */
enum { LAST_RUNS = 4 };

uint32_t share_rows_before(const fray_share *s, uint32_t block) {
  if (block == 0) return 0;
  const row_batch *last = &s->world->batches[s->blocks[block - 1u].batch_end - 1u];
  return (uint32_t)(last->first + last->count);
}

/* All the same: a worker begins a pass when the one before it has come to its end of it, so the slowest
 * sets the pace. Two blocks at least: whoever begins one must not be waited for at its end. */
static void divide(fray_share *s) {
  const uint64_t rows = share_rows_before(s, s->block_count);
  s->owners = s->block_count / 2u < s->workers ? s->block_count / 2u : s->workers;
  for (uint32_t n = 0; n < s->workers; ++n) {
    const uint32_t left = n < s->owners ? 2u * (s->owners - 1u - n) : 0; /* blocks for those behind */
    uint32_t end = s->from[n];
    while (n < s->owners && end < s->block_count - left &&
           (end < s->from[n] + 2u || n + 1u == s->owners ||
            ((uint64_t)share_rows_before(s, end) + share_rows_before(s, end + 1u)) * s->owners <=
                2u * (n + 1u) * rows))
      ++end;
    s->from[n + 1u] = end;
  }
}

/* Only the ends of what a worker has meet others, and where the next one's springs begin: what lies
 * between them becomes one block. Of the last worker's, some: what is done of them in the last pass is
 * hashed by the one before. */
static void join_middles(fray_share *s) {
  uint32_t count = 0;
  s->own_most = 0;
  for (uint32_t n = 0; n < s->workers; ++n) {
    const uint32_t first = s->from[n];
    const uint32_t end = s->from[n + 1u];
    const uint32_t gate = s->gate[n];
    const uint32_t run = n + 1u == s->owners ? (end - first) / (uint32_t)LAST_RUNS + 1u : end - first;
    s->from[n] = count;
    for (uint32_t k = first; k < end; ++k) {
      if (k == gate) s->gate[n] = count;
      if ((k - first) % run == 0 || k + 2u >= end || k + 1u == gate) s->blocks[count++] = s->blocks[k];
    }
    if (count - s->from[n] > s->own_most) s->own_most = count - s->from[n];
  }
  s->from[s->workers] = count;
  s->block_count = count;
}

static share_steps place_steps(const fray_share *s) {
  share_steps at;
  at.own = 1;
  at.near = at.own + 1u;
  at.far = at.near + 1u;
  at.gather = at.far + 1u;
  at.substeps = at.gather + 1u;
  at.tear = at.substeps + s->passes * s->own_most;
  at.hash = at.tear + 1u;
  at.close = at.hash + 1u + (s->owners > 1u ? s->from[s->owners] - s->from[s->owners - 1u] : 0);
  at.end = at.close + 1u;
  return at;
}

void share_order(fray_share *s) {
  if (s->block_count != 0) {
    divide(s);
    seams_cut(s);
    join_middles(s);
  }
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

static fray_need need_one(uint32_t worker, uint32_t steps) {
  const fray_need need = {worker, steps};
  return need;
}

/* Before (pass, block) come (pass, block - 1) and (pass - 1, block + 1), which a neighbour may have, and
 * in the first pass the springs. */
static fray_need need_of_block(const fray_share *s, uint32_t worker, uint32_t step) {
  share_place at;
  if (!share_place_of(s, worker, step, &at)) return need_all(0);
  if (at.block == s->from[worker] && at.block != 0)
    return need_one(worker - 1u, steps_until(s, worker - 1u, at.pass, at.block - 1u));
  if (at.pass == 0 && at.block == s->gate[worker]) return need_one(worker + 1u, s->at.near + 1u);
  if (at.pass != 0 && at.block + 1u == s->from[worker + 1u] && at.block + 1u < s->block_count)
    return need_one(worker + 1u, steps_until(s, worker + 1u, at.pass - 1u, at.block + 1u));
  return need_all(0);
}

fray_need fray_share_need(const fray_share *s, uint32_t worker, uint32_t step) {
  if (s->block_count == 0 || worker >= s->owners)
    return worker == 0 || step != s->at.own ? need_all(0) : need_one(0, 1);
  if (step >= s->at.substeps && step < s->at.tear) return need_of_block(s, worker, step);
  if (step == s->at.own && worker != 0) return need_one(0, 1);
  if (step == s->at.near && worker != 0) return need_one(worker - 1u, s->at.gather);
  if (step == s->at.gather && s->springs_first) return need_all(step);
  /* its last rows reach into the next one's first block */
  if (step == s->at.tear && worker + 1u < s->owners)
    return need_one(worker + 1u, steps_until(s, worker + 1u, s->passes - 1u, s->from[worker + 1u]));
  if (step == s->at.hash && worker != 0 && worker + 1u != s->owners) return need_one(worker - 1u, step + 1u);
  if (step > s->at.hash && step < s->at.close && worker + 2u == s->owners)
    return need_one(worker + 1u, steps_until(s, worker + 1u, s->passes - 1u,
                                             s->from[worker + 1u] + step - s->at.hash - 1u));
  if (step == s->at.close && worker == 0) return need_all(step);
  return need_all(0);
}
