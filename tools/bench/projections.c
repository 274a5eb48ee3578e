/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/projections.h"

#include <stdlib.h>
#include <string.h>

#include "rt/integrate/integrate.h"
#include "rt/woven/woven.h"
#include "tools/bench/float_arrays.h"
#include "tools/bench/float_loop.h"
#include "tools/bench/float_records.h"
#include "tools/bench/timed_tick.h"

enum { ROUNDS = 41, ROWS_A_ROUND = 40000 };

const char *const loop_names[LOOPS] = {"float plain", "float coloured", "float AVX2 by ids",
                                       "float AVX2 in runs"};
const char *const loop_keys[LOOPS] = {"float_plain", "float_coloured", "float_avx2_ids",
                                      "float_avx2_runs"};

typedef struct {
  fray_world *world;
  int32_t *start; /* x, then y, then z */
  float_loop scalar[2];
  float_records records;
  float_arrays arrays;
  uint32_t sweeps; /* a round */
} contest;

static size_t axis_bytes(const fray_world *w) {
  return (size_t)w->p.count * sizeof *w->p.x;
}

static void restore(const contest *c) {
  fray_world *w = c->world;
  const size_t count = (size_t)w->p.count;
  memcpy(w->p.x, c->start, axis_bytes(w));
  memcpy(w->p.y, c->start + count, axis_bytes(w));
  memcpy(w->p.z, c->start + 2 * count, axis_bytes(w));
}

static int keep_start(contest *c) {
  const fray_world *w = c->world;
  const size_t count = (size_t)w->p.count;
  c->start = malloc(3 * axis_bytes(w));
  if (c->start == NULL) return 0;
  memcpy(c->start, w->p.x, axis_bytes(w));
  memcpy(c->start + count, w->p.y, axis_bytes(w));
  memcpy(c->start + 2 * count, w->p.z, axis_bytes(w));
  return 1;
}

static int open_loops(contest *c) {
  int good = float_loop_open(&c->scalar[0], c->world, FLOAT_PLAIN);
  good &= float_loop_open(&c->scalar[1], c->world, FLOAT_COLOURED);
  good &= float_records_open(&c->records, c->world);
  return good & float_arrays_open(&c->arrays, c->world);
}

static void close_loops(contest *c) {
  float_loop_close(&c->scalar[0]);
  float_loop_close(&c->scalar[1]);
  float_records_close(&c->records);
  float_arrays_close(&c->arrays);
  free(c->start);
}

static double time_fray(contest *c, fray_kernel kernel) {
  double ns = 0;
  fray_set_kernel(c->world, kernel);
  c->world->work.projections = 0;
  for (uint32_t n = 0; n < c->sweeps; ++n) {
    restore(c);
    const double before = timed_now_ns();
    strain_limit_apply(c->world);
    ns += timed_now_ns() - before;
  }
  restore(c);
  return ns / c->world->work.projections;
}

static void restore_loop(contest *c, float_loop_name name) {
  if (name == LOOP_RECORDS)
    float_records_restore(&c->records, c->world);
  else if (name == LOOP_ARRAYS)
    float_arrays_restore(&c->arrays, c->world);
  else
    float_loop_restore(&c->scalar[name], c->world);
}

static void sweep_loop(contest *c, float_loop_name name) {
  if (name == LOOP_RECORDS)
    float_records_iterate(&c->records);
  else if (name == LOOP_ARRAYS)
    float_arrays_iterate(&c->arrays);
  else
    float_loop_iterate(&c->scalar[name]);
}

static double time_loop(contest *c, float_loop_name name) {
  double ns = 0;
  for (uint32_t n = 0; n < c->sweeps; ++n) {
    restore_loop(c, name);
    const double before = timed_now_ns();
    sweep_loop(c, name);
    ns += timed_now_ns() - before;
  }
  return ns / ((double)c->sweeps * c->records.rows);
}

/* The scalar loops know nothing of batches: they run where no batch was made idle. */
static int has_loop(const contest *c, uint32_t loop) {
  if (loop == LOOP_PLAIN || loop == LOOP_COLOURED) return c->scalar[loop].rows == c->records.rows;
  return float_avx2_able();
}

/* Both of one round, microseconds apart: a machine that changes its speed changes both. */
static double median_ratio(const double *fray, const double *loop) {
  double ratios[ROUNDS];
  for (uint32_t round = 0; round < ROUNDS; ++round)
    ratios[round] = loop[round] > 0 ? fray[round] / loop[round] : 0;
  return min_median_of(ratios, ROUNDS).median;
}

static void run_rounds(contest *c, const kernels *k, projection_times *t) {
  double fray[KERNELS_MAX][ROUNDS];
  double loop[LOOPS][ROUNDS];
  for (uint32_t round = 0; round < ROUNDS; ++round) {
    for (uint32_t n = 0; n < k->count; ++n) fray[n][round] = time_fray(c, k->list[n]);
    for (uint32_t n = 0; n < LOOPS; ++n)
      loop[n][round] = has_loop(c, n) ? time_loop(c, (float_loop_name)n) : 0;
  }
  for (uint32_t n = 0; n < k->count; ++n)
    for (uint32_t l = 0; l < LOOPS; ++l) t->ratio[n][l] = median_ratio(fray[n], loop[l]);
  for (uint32_t n = 0; n < k->count; ++n) t->fray[n] = min_median_of(fray[n], ROUNDS);
  for (uint32_t n = 0; n < LOOPS; ++n) t->loop[n] = min_median_of(loop[n], ROUNDS);
}

int projections_time(fray_world *w, const kernels *k, projection_times *t) {
  contest c;
  memset(&c, 0, sizeof c);
  memset(t, 0, sizeof *t);
  c.world = w;
  bodies_advance(w, 0);
  particles_advance(w);
  particles_carry(w);
  int good = keep_start(&c);
  good &= open_loops(&c);
  t->rows = c.records.rows;
  t->springs_in_runs = c.arrays.springs_in_runs;
  good = good && t->rows > 0;
  if (good) {
    c.sweeps = ROWS_A_ROUND / t->rows + 1;
    run_rounds(&c, k, t);
  }
  close_loops(&c);
  return good;
}

static int is_run(const fray_world *w, const spring_batch *b) {
  int32_t runs = 1;
  for (int32_t row = b->first + 1; row < b->first + b->count; ++row)
    if (w->woven.spring_i[row] != w->woven.spring_i[row - 1] + 1u || w->woven.spring_j[row] != w->woven.spring_j[row - 1] + 1u) ++runs;
  return b->count >= RUN_MEAN * runs;
}

uint32_t projections_keep_runs(struct world_file *o) {
  fray_world *w = o->world;
  spring_batch *batches = (spring_batch *)(uintptr_t)w->woven.batches; /* in o->image or o->memory: ours */
  uint32_t rows = 0;
  for (int32_t n = 0; n < w->params->link_batches; ++n) {
    if (batches[n].attached == BATCH_INACTIVE) continue;
    if (is_run(w, &batches[n]))
      rows += (uint32_t)batches[n].count;
    else
      batches[n].attached = BATCH_INACTIVE;
  }
  return rows;
}
