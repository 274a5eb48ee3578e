/* SPDX-License-Identifier: Apache-2.0 */
/* Which worker does what, in which step, and what it waits for. */
#include "rt/workers/parallel.h"

/* Into how many blocks the middle of the last worker's blocks is joined. */
enum { LAST_RUNS = 4 };

uint32_t schedule_springs_before(const fray_parallel *par, uint32_t block) {
  FRAY_ASSERT(block <= par->block_count);
  if (block == 0) return 0;
  const spring_batch *last = &par->world->woven.batches[par->blocks[block - 1u].batch_end - 1u];
  return (uint32_t)(last->first + last->count);
}

/* Every owner gets about as many links: a worker begins a pass when the one before it has finished its part
 * of that pass, so the slowest sets the pace. Each has at least two blocks: a block that waits for the
 * worker before must not be one that the worker before waits for. */
static void distribute_blocks(fray_parallel *par) {
  const uint64_t links = schedule_springs_before(par, par->block_count);
  par->owners = par->block_count / 2u < par->workers ? par->block_count / 2u : par->workers;
  for (uint32_t n = 0; n < par->workers; ++n) {
    /* blocks for later workers */
    const uint32_t reserved = n < par->owners ? 2u * (par->owners - 1u - n) : 0;
    uint32_t end = par->block_from[n];
    while (n < par->owners && end < par->block_count - reserved &&
           (end < par->block_from[n] + 2u || n + 1u == par->owners ||
            ((uint64_t)schedule_springs_before(par, end) + schedule_springs_before(par, end + 1u)) *
                    par->owners <=
                2u * (n + 1u) * links))
      ++end;
    par->block_from[n + 1u] = end;
  }
}

/* Only the first and last blocks of a worker touch particles of others, and the block before its gate: those
 * between them are joined to one. The last worker's are joined to some: the worker before hashes them one by
 * one in the last pass. */
static void join_middle_blocks(fray_parallel *par) {
  uint32_t count = 0;
  par->steps_per_pass = 0;
  for (uint32_t n = 0; n < par->workers; ++n) {
    const uint32_t first = par->block_from[n];
    const uint32_t end = par->block_from[n + 1u];
    const uint32_t gate = par->gate_block[n];
    const uint32_t run = n + 1u == par->owners ? (end - first) / (uint32_t)LAST_RUNS + 1u : end - first;
    par->block_from[n] = count;
    for (uint32_t k = first; k < end; ++k) {
      if (k == gate) par->gate_block[n] = count;
      if ((k - first) % run == 0 || k + 2u >= end || k + 1u == gate) par->blocks[count++] = par->blocks[k];
    }
    if (count - par->block_from[n] > par->steps_per_pass) par->steps_per_pass = count - par->block_from[n];
  }
  par->block_from[par->workers] = count;
  par->block_count = count;
}

static parallel_steps number_steps(const fray_parallel *par) {
  parallel_steps step;
  step.own = 1;
  step.near = step.own + 1u;
  step.far = step.near + 1u;
  step.gather = step.far + 1u;
  step.substeps = step.gather + 1u;
  step.tear = step.substeps + par->passes * par->steps_per_pass;
  step.hash = step.tear + 1u;
  step.close = step.hash + 1u +
               (par->owners > 1u ? par->block_from[par->owners] - par->block_from[par->owners - 1u] : 0);
  step.end = step.close + 1u;
  return step;
}

void schedule_make(fray_parallel *par) {
  FRAY_ASSERT(par->block_count <= BLOCKS_MAX && par->block_count != 1u);
  FRAY_ASSERT(par->workers >= 1u && par->workers <= FRAY_WORKERS_MAX);
  if (par->block_count != 0) {
    distribute_blocks(par);
    spring_partition_make(par);
    join_middle_blocks(par);
  }
  par->step = number_steps(par);
}

uint32_t fray_parallel_steps(const fray_parallel *par) {
  FRAY_ASSERT(par != NULL);
  return par->step.end;
}

/* All workers must have done `steps` steps: none for 0. */
static fray_dependency after_all(uint32_t steps) {
  const fray_dependency need = {FRAY_ALL_WORKERS, steps};
  return need;
}

static fray_dependency after_worker(uint32_t worker, uint32_t steps) {
  const fray_dependency need = {worker, steps};
  return need;
}

int schedule_entry_at(const fray_parallel *par, uint32_t worker, uint32_t step, schedule_entry *entry) {
  FRAY_ASSERT(worker < par->workers && step >= par->step.substeps && step < par->step.tear);
  const uint32_t n = step - par->step.substeps;
  entry->pass = n / par->steps_per_pass;
  entry->block = par->block_from[worker] + n % par->steps_per_pass;
  return entry->block < par->block_from[worker + 1u];
}

/* How many steps a worker has done once it is through with a block in a pass. */
static uint32_t steps_through(const fray_parallel *par, uint32_t worker, uint32_t pass, uint32_t block) {
  FRAY_ASSERT(block >= par->block_from[worker] && block < par->block_from[worker + 1u]);
  return par->step.substeps + pass * par->steps_per_pass + (block - par->block_from[worker]) + 1u;
}

/* Before (pass, block) come (pass, block - 1) and (pass - 1, block + 1), which may be a neighbour's, and in
 * the first pass the springs. */
static fray_dependency dependency_of_block(const fray_parallel *par, uint32_t worker, uint32_t step) {
  schedule_entry at;
  if (!schedule_entry_at(par, worker, step, &at)) return after_all(0);
  if (at.block == par->block_from[worker] && at.block != 0)
    return after_worker(worker - 1u, steps_through(par, worker - 1u, at.pass, at.block - 1u));
  if (at.pass == 0 && at.block == par->gate_block[worker])
    return after_worker(worker + 1u, par->step.near + 1u);
  if (at.pass != 0 && at.block + 1u == par->block_from[worker + 1u] && at.block + 1u < par->block_count)
    return after_worker(worker + 1u, steps_through(par, worker + 1u, at.pass - 1u, at.block + 1u));
  return after_all(0);
}

fray_dependency fray_parallel_dependency(const fray_parallel *par, uint32_t worker, uint32_t step) {
  FRAY_ASSERT(par != NULL && worker < par->workers && step < par->step.end);
  if (par->block_count == 0 || worker >= par->owners)
    return worker == 0 || step != par->step.own ? after_all(0) : after_worker(0, 1);
  if (step >= par->step.substeps && step < par->step.tear) return dependency_of_block(par, worker, step);
  if (step == par->step.own && worker != 0) return after_worker(0, 1);
  if (step == par->step.near && worker != 0) return after_worker(worker - 1u, par->step.gather);
  if (step == par->step.gather && par->springs_first) return after_all(step);
  const uint32_t last_pass = par->passes - 1u;
  const uint32_t next = worker + 1u;
  /* its last links reach into the next worker's first block */
  if (step == par->step.tear && next < par->owners)
    return after_worker(next, steps_through(par, next, last_pass, par->block_from[next]));
  if (step == par->step.hash && worker != 0 && next != par->owners)
    return after_worker(worker - 1u, step + 1u);
  if (step > par->step.hash && step < par->step.close && worker + 2u == par->owners)
    return after_worker(next, steps_through(par, next, last_pass,
                                            par->block_from[next] + step - par->step.hash - 1u));
  if (step == par->step.close && worker == 0) return after_all(step);
  return after_all(0);
}
