/* SPDX-License-Identifier: Apache-2.0 */
/* Distributes bend and shear springs, by the higher of the numbers of their two particles. They read
 * positions, and add to velocities amounts that do not depend on velocities, so their order is free; but no
 * two workers may touch a particle at the same time.
 *
 * A worker has the springs from particle `spring_from` on, up to those of the next worker. Its far springs
 * touch only its own particles, and none that the worker before has in the substeps; they may be applied at
 * any time. Its own springs touch particles that the worker before will have in the substeps. Its near
 * springs touch particles that the worker before has in the springs, down to `lowest`: they wait for the
 * springs of the worker before, and the substeps of that one wait for them, from the first block that
 * reaches `lowest`. So workers that begin their substeps later, because they follow others, can apply more
 * springs meanwhile. */
#include "rt/workers/parallel.h"

static uint32_t low_end(const fray_world *w, uint32_t spring) {
  FRAY_ASSERT(spring < w->capacity[POOL_SPRINGS]);
  const uint32_t i = w->woven.spring_i[spring];
  const uint32_t j = w->woven.spring_j[spring];
  return i < j ? i : j;
}

static uint32_t high_end(const fray_world *w, uint32_t spring) {
  FRAY_ASSERT(spring < w->capacity[POOL_SPRINGS]);
  const uint32_t i = w->woven.spring_i[spring];
  const uint32_t j = w->woven.spring_j[spring];
  return i < j ? j : i;
}

static uint32_t batch_end(const spring_batch *b) { return (uint32_t)(b->first + b->count); }

/* The spans of a batch of springs, by worker. */
static spring_span *spans_of(const fray_parallel *par, uint32_t b) {
  FRAY_ASSERT(b >= (uint32_t)par->world->params->link_batches && b < par->world->capacity[POOL_BATCHES]);
  return par->spans + (size_t)(b - (uint32_t)par->world->params->link_batches) * (par->workers + 1u);
}

/* A worker's springs begin with the first one that has its higher end among the worker's particles. */
static void divide_batch(fray_parallel *par, const spring_batch *b, spring_span *spans) {
  const fray_world *w = par->world;
  uint32_t n = 0;
  spans[0].near = spans[0].own = spans[0].far = (uint32_t)b->first;
  for (uint32_t spring = (uint32_t)b->first; spring < batch_end(b); ++spring) {
    const uint32_t low = low_end(w, spring);
    while (n + 1u < par->owners && high_end(w, spring) >= par->spring_from[n + 1u]) {
      ++n;
      spans[n].near = spans[n].own = spans[n].far = spring;
    }
    if (low < par->spring_from[n]) spans[n].own = spring + 1u;
    if (low < par->far_from[n]) spans[n].far = spring + 1u;
    if (low < par->lowest[n]) par->lowest[n] = low;
  }
  while (n++ < par->workers) spans[n].near = spans[n].own = spans[n].far = batch_end(b);
}

/* The number of springs for each worker: one that begins its substeps after others have done a pass gets as
 * many more as their links and particles cost, at 5/4 springs a link. The same number for all where
 * contacts are gathered in between. */
static void count_springs(const fray_parallel *par, uint64_t springs[FRAY_WORKERS_MAX]) {
  const params *p = par->world->params;
  const uint64_t all = (uint32_t)p->bends + (uint32_t)p->shears;
  uint64_t extra[FRAY_WORKERS_MAX];
  uint64_t sum = 0;
  for (uint32_t n = 0; n < par->owners; ++n) {
    extra[n] = par->gathers ? 0 : (uint64_t)schedule_springs_before(par, par->block_from[n]) * 5u / 4u;
    sum += extra[n];
  }
  for (uint32_t n = 0; n < par->owners; ++n)
    springs[n] = sum <= all ? (all - sum) / par->owners + extra[n] : all * extra[n] / sum;
}

/* The particle where a worker's springs begin, at `particle` or later: at the end of a block of the worker
 * before, but not of its first ones. */
static uint32_t begin_springs(const fray_parallel *par, uint32_t worker, uint64_t particle) {
  FRAY_ASSERT(worker > 0 && worker < par->owners);
  const uint32_t last = par->block_from[worker] - 1u;
  uint32_t k = par->block_from[worker - 1u] + 3u;
  if (par->gathers || k > last) k = last;
  while (k < last && par->blocks[k].finish_end < particle) ++k;
  return par->blocks[k].finish_end;
}

static void divide_particles(fray_parallel *par) {
  const params *p = par->world->params;
  const uint64_t free_particles = (uint32_t)(p->particles - p->attached);
  const uint64_t all = (uint64_t)(uint32_t)p->bends + (uint32_t)p->shears + 1u;
  uint64_t springs[FRAY_WORKERS_MAX];
  uint64_t before = 0;
  count_springs(par, springs);
  for (uint32_t n = 0; n <= par->workers; ++n) {
    par->spring_from[n] = n == 0 ? 0 : (uint32_t)p->particles;
    par->far_from[n] = par->spring_from[n];
    par->lowest[n] = par->spring_from[n];
    if (n == 0 || n >= par->owners) continue;
    before += springs[n - 1u];
    const uint32_t from = begin_springs(par, n, (uint32_t)p->attached + before * free_particles / all);
    const uint32_t substeps_end = par->blocks[par->block_from[n] - 1u].advance_end; /* of the worker before */
    par->spring_from[n] = par->lowest[n] = from;
    par->far_from[n] = from > substeps_end ? from : substeps_end;
  }
}

/* The block of each worker that must wait for the near springs of the next one. If that would be its first
 * block, which already waits for the worker before, or if springs reach across a whole worker: all springs
 * first. */
static void place_gates(fray_parallel *par) {
  par->springs_first = par->gathers;
  for (uint32_t n = 0; n < par->workers; ++n) par->gate_block[n] = PARALLEL_NO_GATE;
  for (uint32_t n = 1; n < par->owners; ++n) {
    uint32_t k = par->block_from[n - 1u];
    if (par->blocks[k].advance_end > par->lowest[n]) par->springs_first = 1;
    if (k > 0 && par->blocks[k - 1u].advance_end > par->lowest[n]) par->springs_first = 1;
    while (k < par->block_from[n] && par->blocks[k].advance_end <= par->lowest[n]) ++k;
    if (k < par->block_from[n]) par->gate_block[n - 1u] = k;
  }
}

void spring_partition_make(fray_parallel *par) {
  FRAY_ASSERT(par->owners >= 1u && par->owners <= par->workers);
  const fray_world *w = par->world;
  divide_particles(par);
  for (uint32_t b = (uint32_t)w->params->link_batches; b < w->capacity[POOL_BATCHES]; ++b)
    divide_batch(par, &w->woven.batches[b], spans_of(par, b));
  place_gates(par);
  FRAY_ASSERT(spring_partition_holds(par));
}

int spring_partition_holds(const fray_parallel *par) {
  FRAY_ASSERT(par->owners <= par->workers);
  const fray_world *w = par->world;
  for (uint32_t b = (uint32_t)w->params->link_batches; b < w->capacity[POOL_BATCHES]; ++b)
    for (uint32_t n = 0; n < par->owners; ++n) {
      const spring_span *span = spans_of(par, b) + n;
      for (uint32_t spring = span->near; spring < span[1].near; ++spring)
        if (low_end(w, spring) < (spring < span->own   ? par->lowest[n]
                                  : spring < span->far ? par->spring_from[n]
                                                       : par->far_from[n]) ||
            high_end(w, spring) >= par->spring_from[n + 1u])
          return 0;
    }
  return 1;
}
