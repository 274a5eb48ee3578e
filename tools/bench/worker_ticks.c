/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/worker_ticks.h"

#include <stdlib.h>
#include <string.h>

#include "tools/bench/timed_tick.h"
#include "tools/world/world_workers.h"

enum { TURN = 5, TURNS_MAX = 200 };

/* The two worlds, and how long each turn took. */
typedef struct {
  struct world_file one, shared;
  world_workers world_workers;
  double one_ns[TURNS_MAX], workers_ns[TURNS_MAX];
} race;

static int copy_world(const fray_world *from, struct world_file *to) {
  memset(to, 0, sizeof *to);
  to->image_bytes = fray_save_bytes(from);
  to->image = malloc(to->image_bytes);
  return to->image != NULL && fray_save(from, to->image, to->image_bytes) != 0 &&
         world_file_open_image("copy", to, stderr) == 0;
}

static int by_length(const void *a, const void *b) {
  const double x = *(const double *)a;
  const double y = *(const double *)b;
  return (x > y) - (x < y);
}

static double best_tenth(double *ns, uint32_t turns) {
  qsort(ns, turns, sizeof *ns, by_length);
  return ns[turns / 10] / TURN / 1e3;
}

static double time_one(race *r, const session *s, uint32_t from, uint64_t *hash) {
  fray_output out;
  double begun = 0;
  for (uint32_t k = 0; k <= TURN; ++k) {
    if (k == 1) begun = timed_now_ns();
    fray_tick(r->one.world, session_input(s, from + k), &out);
  }
  *hash = out.hash;
  return timed_now_ns() - begun;
}

static double time_workers(race *r, const session *s, uint32_t from, uint64_t *hash) {
  fray_output out;
  double begun = 0;
  for (uint32_t k = 0; k <= TURN; ++k) {
    if (k == 1) begun = timed_now_ns();
    workers_tick(&r->world_workers.group, session_input(s, from + k), &out);
  }
  *hash = out.hash;
  return timed_now_ns() - begun;
}

/* The first tick of a turn is not timed: it fetches the world and wakes the workers. */
static int run_turns(race *r, const session *s, uint32_t turns) {
  uint64_t one, shared;
  for (uint32_t n = 0; n < turns; ++n) {
    const uint32_t from = n * (TURN + 1u);
    r->one_ns[n] = time_one(r, s, from, &one);
    r->workers_ns[n] = time_workers(r, s, from, &shared);
    if (one == shared) continue;
    fprintf(stderr, "tick %u: the hash of shared ticks differs\n", from + TURN);
    return 0;
  }
  return 1;
}

int worker_ticks_time(const session *s, uint32_t ticks, uint32_t workers, worker_times *t) {
  race *r = world_workers_alloc(sizeof *r);
  const uint32_t ticks_a_turn = TURN + 1u;
  uint32_t turns = ticks / ticks_a_turn < TURNS_MAX ? ticks / ticks_a_turn : (uint32_t)TURNS_MAX;
  if (turns == 0) turns = 1;
  t->workers = workers;
  t->chosen = workers_count(s->world_file.world, 0);
  int good = r != NULL && copy_world(s->world_file.world, &r->one) &&
             copy_world(s->world_file.world, &r->shared);
  const int cpu = workers <= workers_cpus() ? 0 : WORKERS_ANY_CPU;
  if (good && world_workers_open(&r->world_workers, r->shared.world, workers, cpu)) {
    good = run_turns(r, s, turns);
    world_workers_close(&r->world_workers);
    t->one_us = best_tenth(r->one_ns, turns);
    t->workers_us = best_tenth(r->workers_ns, turns);
  } else {
    good = 0;
  }
  if (r != NULL) {
    world_file_close(&r->one);
    world_file_close(&r->shared);
  }
  free(r);
  return good;
}

void worker_ticks_print(FILE *out, const worker_times *t) {
  fprintf(out,
          "  %u workers: %.1f us a tick, one beside them %.1f us: %.2f times as fast; --workers 0 "
          "takes %u\n",
          t->workers, t->workers_us, t->one_us, t->one_us / t->workers_us, t->chosen);
}
