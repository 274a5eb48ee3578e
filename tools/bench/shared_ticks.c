/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/shared_ticks.h"

#include <stdlib.h>
#include <string.h>

#include "tools/bench/timed_tick.h"
#include "tools/crew.h"

enum { TURN = 5, TURNS_MAX = 200 };

/* The two worlds, and how long each turn took. */
typedef struct {
  struct opened one, shared;
  crew crew;
  double one_ns[TURNS_MAX], shared_ns[TURNS_MAX];
} race;

static int copy_world(const fray_world *from, struct opened *to) {
  memset(to, 0, sizeof *to);
  to->image_bytes = fray_save_bytes(from);
  to->image = malloc(to->image_bytes);
  return to->image != NULL && fray_save(from, to->image, to->image_bytes) != 0 &&
         world_open_image("copy", to, stderr) == 0;
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

static double time_shared(race *r, const session *s, uint32_t from, uint64_t *hash) {
  fray_output out;
  double begun = 0;
  for (uint32_t k = 0; k <= TURN; ++k) {
    if (k == 1) begun = timed_now_ns();
    team_tick(&r->crew.team, session_input(s, from + k), &out);
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
    r->shared_ns[n] = time_shared(r, s, from, &shared);
    if (one == shared) continue;
    fprintf(stderr, "tick %u: the hash of shared ticks differs\n", from + TURN);
    return 0;
  }
  return 1;
}

int shared_ticks_time(const session *s, uint32_t ticks, uint32_t workers, shared_times *t) {
  race *r = crew_room(sizeof *r);
  const uint32_t ticks_a_turn = TURN + 1u;
  uint32_t turns = ticks / ticks_a_turn < TURNS_MAX ? ticks / ticks_a_turn : (uint32_t)TURNS_MAX;
  if (turns == 0) turns = 1;
  t->workers = workers;
  t->chosen = team_size(s->opened.world, 0);
  int good = r != NULL && copy_world(s->opened.world, &r->one) &&
             copy_world(s->opened.world, &r->shared);
  const int cpu = workers <= team_cpus() ? 0 : TEAM_ANY_CPU;
  if (good && crew_open(&r->crew, r->shared.world, workers, cpu)) {
    good = run_turns(r, s, turns);
    crew_close(&r->crew);
    t->one_us = best_tenth(r->one_ns, turns);
    t->shared_us = best_tenth(r->shared_ns, turns);
  } else {
    good = 0;
  }
  if (r != NULL) {
    world_close(&r->one);
    world_close(&r->shared);
  }
  free(r);
  return good;
}

void shared_ticks_print(FILE *out, const shared_times *t) {
  fprintf(out,
          "  %u workers: %.1f us a tick, one beside them %.1f us: %.2f times as fast; --workers 0 "
          "takes %u\n",
          t->workers, t->shared_us, t->one_us, t->one_us / t->shared_us, t->chosen);
}
