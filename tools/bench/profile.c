/* SPDX-License-Identifier: Apache-2.0 */
#include "tools/bench/profile.h"

#include <stdlib.h>
#include <string.h>

enum { RUNS = 3, CHUNK = 25 /* ticks of one kernel, then of the next */ };
enum { EACH_SUBSTEP = 4, ONCE_A_TICK = TIMED_COUNT - EACH_SUBSTEP }; /* stages */
#define UNKNOWN_NS 1e9f
#define INTERRUPTED 1.05 /* the clock by the thread's own time */
#define LONG_STAGE_NS 5e4 /* a look at the thread's own time is a system call, up to 1 us */

typedef struct {
  struct world_file world_file;
  float *stage_ns; /* least of the runs: ticks x TIMED_COUNT */
  float *tick_ns;  /* likewise */
  uint32_t *work;
  uint64_t projections;
  double run_ns[RUNS];
  uint64_t hash;
  uint32_t looks; /* at the clock in a tick */
  int by_cpu; /* known after the first tick */
  uint32_t first_tear, behind_last_tear; /* ticks; both 0: none */
} track;

static uint32_t counted(const fray_work *k) {
  return k->particle_steps + k->projections + k->springs + k->contacts + k->tear_tests + k->tears;
}

static float less(float a, double b) { return (double)a < b ? a : (float)b; }

/* Takes what others had of the processor off the stage in which they had it: the longest, as one
 * turn of theirs is longer than most stages. Where that is not enough there were several turns, and
 * every stage is made shorter; returns 0 then, as that is a guess. */
static int mend_stages(double wall_ns, double cpu_ns) {
  int longest = 0;
  for (int n = 1; n < TIMED_COUNT; ++n)
    if (timed_ns[n] > timed_ns[longest]) longest = n;
  const int good = timed_ns[longest] > wall_ns - cpu_ns;
  if (good) timed_ns[longest] -= wall_ns - cpu_ns;
  for (int n = 0; !good && n < TIMED_COUNT; ++n) timed_ns[n] *= cpu_ns / wall_ns;
  return good;
}

static void take_times(track *t, uint32_t tick, double ns) {
  float *stage_ns = t->stage_ns + (size_t)tick * TIMED_COUNT;
  t->tick_ns[tick] = less(t->tick_ns[tick], ns);
  for (int n = 0; n < TIMED_COUNT; ++n) stage_ns[n] = less(stage_ns[n], timed_ns[n]);
}

static void run_tick(track *t, const fray_input *input, uint32_t tick, uint32_t run) {
  fray_output out;
  memset(timed_ns, 0, sizeof timed_ns);
  timed_by_cpu = t->by_cpu;
  const double cpu_before = timed_cpu_ns();
  const double before = timed_now_ns();
  timed_tick(t->world_file.world, input, &out);
  const double wall_ns = timed_now_ns() - before;
  const double cpu_ns = timed_cpu_ns() - cpu_before;
  const int interrupted = wall_ns > cpu_ns * INTERRUPTED;
  const double ns = interrupted ? cpu_ns : wall_ns;
  const int known = !interrupted || t->by_cpu || mend_stages(wall_ns, cpu_ns);
  if (known || t->tick_ns[tick] == UNKNOWN_NS) take_times(t, tick, ns);
  if (tick == 0) t->by_cpu = cpu_ns > LONG_STAGE_NS * t->looks;
  t->run_ns[run] += ns;
  t->work[tick] = counted(&out.work);
  t->hash = out.hash;
  if (run == 0) t->projections += out.work.projections;
  if (run != 0 || out.work.tears == 0) return;
  if (t->behind_last_tear == 0) t->first_tear = tick;
  t->behind_last_tear = tick + 1;
}

static int open_track(track *t, uint32_t ticks, uint32_t substeps) {
  memset(t, 0, sizeof *t);
  t->looks = ONCE_A_TICK + EACH_SUBSTEP * substeps;
  t->stage_ns = malloc((size_t)ticks * TIMED_COUNT * sizeof *t->stage_ns);
  t->tick_ns = malloc(ticks * sizeof *t->tick_ns);
  t->work = malloc(ticks * sizeof *t->work);
  if (!t->stage_ns || !t->tick_ns || !t->work) return 0;
  for (size_t n = 0; n < (size_t)ticks * TIMED_COUNT; ++n) t->stage_ns[n] = UNKNOWN_NS;
  for (uint32_t n = 0; n < ticks; ++n) t->tick_ns[n] = UNKNOWN_NS;
  return 1;
}

static void close_track(track *t) {
  free(t->stage_ns);
  free(t->tick_ns);
  free(t->work);
}

/* Every kernel through all ticks once, from the start, in turns. */
static int take_run(const session *s, const kernels *k, uint32_t ticks, track *tracks,
                    uint32_t run) {
  int good = 1;
  for (uint32_t n = 0; n < k->count; ++n) {
    good = good && kernels_reopen_world(&s->world_file, &tracks[n].world_file);
    if (good) fray_set_kernel(tracks[n].world_file.world, k->list[n]);
  }
  for (uint32_t first = 0; good && first < ticks; first += CHUNK)
    for (uint32_t n = 0; n < k->count; ++n)
      for (uint32_t tick = first; tick < ticks && tick < first + CHUNK; ++tick)
        run_tick(&tracks[n], session_input(s, tick), tick, run);
  for (uint32_t n = 0; n < k->count; ++n) world_file_close(&tracks[n].world_file);
  return good;
}

static int by_size(const void *a, const void *b) {
  const uint32_t x = *(const uint32_t *)a;
  const uint32_t y = *(const uint32_t *)b;
  return (x > y) - (x < y);
}

static void sum_up(track *t, const session *s, uint32_t ticks, profile *p) {
  double total = 0;
  for (uint32_t tick = 0; tick < ticks; ++tick) {
    const double ns = (double)t->tick_ns[tick];
    total += ns;
    if (ns > p->worst_ns) p->worst_ns = ns;
    for (int n = 0; n < TIMED_COUNT; ++n)
      p->stage_ns[n] += (double)t->stage_ns[(size_t)tick * TIMED_COUNT + (size_t)n] / ticks;
  }
  p->projection_ns = p->stage_ns[TIMED_STRAIN] * ticks / (double)t->projections;
  p->ticks = ticks;
  p->rate_hz = s->facts.rate_hz;
  p->substeps = s->facts.substeps;
  p->tick_ns = (min_median){total / ticks, min_median_of(t->run_ns, RUNS).median / ticks};
  qsort(t->work, ticks, sizeof *t->work, by_size);
  p->work_median = t->work[ticks / 2];
  p->work_worst = t->work[ticks - 1];
  p->hash = t->hash;
  if (s->facts.triangles_max == 0 || t->behind_last_tear == 0) return;
  p->phases[TEAR_BEFORE] = tear_phase_of(t->stage_ns, 0, t->first_tear);
  p->phases[TEAR_WHILE] = tear_phase_of(t->stage_ns, t->first_tear, t->behind_last_tear);
}

int profiles_take(const session *s, const kernels *k, uint32_t ticks, profile *profiles) {
  track tracks[KERNELS_MAX];
  int good = 1;
  memset(profiles, 0, k->count * sizeof *profiles);
  for (uint32_t n = 0; n < k->count; ++n) good &= open_track(&tracks[n], ticks, s->facts.substeps);
  for (uint32_t run = 0; good && run < RUNS; ++run) good = take_run(s, k, ticks, tracks, run);
  for (uint32_t n = 0; n < k->count; ++n) {
    profiles[n].kernel = k->list[n];
    if (good) sum_up(&tracks[n], s, ticks, &profiles[n]);
    close_track(&tracks[n]);
  }
  return good;
}

double profile_share(const profile *p, double ns) {
  double all_ns = 0;
  for (int n = 0; n < TIMED_COUNT; ++n) all_ns += p->stage_ns[n];
  return 100 * ns / all_ns;
}

double profile_real_time(const profile *p) { return 1e9 / p->rate_hz / p->tick_ns.min; }
