/* SPDX-License-Identifier: Apache-2.0 */
#define _GNU_SOURCE

#include "platform/linux/team.h"

#include <signal.h>
#include <string.h>

#ifndef TEAM_STACK
#define TEAM_STACK (1 << 17) /* kernels that a compiler does not optimise take more */
#endif

/* Who waits looks so often, then lets others run so often, then sleeps. A look is some 20 ns. */
enum { LOOKS = 2000, TURNS = 20 };

static void relax(void) {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  __asm__ volatile("yield");
#endif
}

static int has_done(team_worker *w, uint32_t steps) {
  return (int32_t)(atomic_load_explicit(&w->done, memory_order_acquire) - steps) >= 0;
}

static int is_over(team_worker *w, uint32_t steps, team *t) {
  return has_done(w, steps) || atomic_load_explicit(&t->stop, memory_order_relaxed);
}

/* What a sleeper misses between its last look and its sleep, publish() sees: it stores first and then
 * asks for sleepers, a sleeper counts itself first and then looks. */
static void sleep_until(team *t, team_worker *w, uint32_t steps) {
  (void)pthread_mutex_lock(&t->lock);
  atomic_fetch_add(&t->sleepers, 1);
  while ((int32_t)(atomic_load(&w->done) - steps) < 0 && !atomic_load(&t->stop))
    (void)pthread_cond_wait(&t->moved, &t->lock);
  atomic_fetch_sub(&t->sleepers, 1);
  (void)pthread_mutex_unlock(&t->lock);
}

static void wait_for(team *t, team_worker *w, uint32_t steps) {
  for (uint32_t n = 0; n < t->looks; ++n) {
    if (is_over(w, steps, t)) return;
    relax();
  }
  for (uint32_t n = 0; n < TURNS; ++n) {
    if (is_over(w, steps, t)) return;
    (void)sched_yield();
  }
  sleep_until(t, w, steps);
}

static void wake(team *t) {
  (void)pthread_mutex_lock(&t->lock);
  (void)pthread_cond_broadcast(&t->moved);
  (void)pthread_mutex_unlock(&t->lock);
}

static void publish(team *t, team_worker *w, uint32_t steps) {
  atomic_store(&w->done, steps);
  if (atomic_load(&t->sleepers) != 0) wake(t);
}

static void await(team *t, const team_worker *own, fray_need need, uint32_t base) {
  if (need.steps == 0) return;
  if (need.worker != FRAY_EVERYONE) {
    wait_for(t, &t->worker[need.worker], base + need.steps);
    return;
  }
  for (uint32_t n = 0; n < t->workers; ++n)
    if (n != own->number) wait_for(t, &t->worker[n], base + need.steps);
}

static void run_tick(team_worker *w, uint32_t base, const fray_input *input, fray_output *output) {
  team *t = w->of;
  for (uint32_t n = 0; n < t->steps; ++n) {
    await(t, w, fray_share_need(t->share, w->number, n), base);
    if (atomic_load_explicit(&t->stop, memory_order_relaxed)) return;
    fray_share_step(t->share, w->number, n, input, output);
    publish(t, w, base + n + 1u);
  }
}

/* A tick begins for the others when worker 0 has done its first step. */
static void *run_worker(void *context) {
  team_worker *w = context;
  for (uint32_t base = 0; !atomic_load(&w->of->stop); base += w->of->steps)
    run_tick(w, base, NULL, NULL);
  return NULL;
}

uint32_t team_cpus(void) {
  cpu_set_t set;
  return sched_getaffinity(0, sizeof set, &set) == 0 ? (uint32_t)CPU_COUNT(&set) : 1u;
}

static int pin(pthread_t thread, const cpu_set_t *set, int cpu, uint32_t n) {
  cpu_set_t one;
  CPU_ZERO(&one);
  for (uint32_t seen = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (!CPU_ISSET((unsigned)cpu, set) || seen++ != n) continue;
    CPU_SET((unsigned)cpu, &one);
    return pthread_setaffinity_np(thread, sizeof one, &one) == 0;
  }
  return 0;
}

uint32_t team_size(const fray_world *world, uint32_t workers) {
  if (workers == 0) return fray_share_useful(world, team_cpus());
  return workers < FRAY_WORKERS_MAX ? workers : (uint32_t)FRAY_WORKERS_MAX;
}

size_t team_bytes(const fray_world *world, uint32_t workers) {
  return workers > 1 ? fray_share_bytes(world, workers) : 0;
}

/* Without signals: they are the caller's. */
static int start_threads(team *t) {
  pthread_attr_t attributes;
  sigset_t all, before;
  if (pthread_attr_init(&attributes) != 0) return 0;
  (void)pthread_attr_setstacksize(&attributes, TEAM_STACK);
  sigfillset(&all);
  (void)pthread_sigmask(SIG_BLOCK, &all, &before);
  for (t->started = 1; t->started < t->workers; ++t->started) {
    team_worker *w = &t->worker[t->started];
    if (pthread_create(&w->thread, &attributes, run_worker, w) != 0) break;
  }
  (void)pthread_sigmask(SIG_SETMASK, &before, NULL);
  (void)pthread_attr_destroy(&attributes);
  return t->started == t->workers;
}

static int pin_all(team *t, int cpu) {
  if (cpu == TEAM_ANY_CPU) return 1;
  if (sched_getaffinity(0, sizeof t->before, &t->before) != 0) return 0;
  t->pinned = 1;
  int good = pin(pthread_self(), &t->before, cpu, 0);
  for (uint32_t n = 1; n < t->workers; ++n) good &= pin(t->worker[n].thread, &t->before, cpu, n);
  return good;
}

int team_open(team *t, fray_world *world, uint32_t workers, int cpu, void *memory, size_t bytes) {
  memset(t, 0, sizeof *t);
  t->world = world;
  t->workers = workers;
  if (workers <= 1) return 1;
  t->share = fray_share_open(world, workers, memory, bytes);
  if (t->share == NULL) return 0;
  t->steps = fray_share_steps(t->share);
  t->looks = team_cpus() < workers ? 0 : LOOKS; /* who is waited for may want this very CPU */
  (void)pthread_mutex_init(&t->lock, NULL);
  (void)pthread_cond_init(&t->moved, NULL);
  for (uint32_t n = 0; n < workers; ++n) {
    t->worker[n].of = t;
    t->worker[n].number = n;
  }
  if (start_threads(t) && pin_all(t, cpu)) return 1;
  team_close(t);
  return 0;
}

void team_tick(team *t, const fray_input *input, fray_output *output) {
  if (t->share == NULL) {
    fray_tick(t->world, input, output);
    return;
  }
  run_tick(&t->worker[0], t->base, input, output);
  t->base += t->steps;
}

void team_close(team *t) {
  if (t->share == NULL) return;
  atomic_store(&t->stop, 1);
  wake(t);
  for (uint32_t n = 1; n < t->started; ++n) (void)pthread_join(t->worker[n].thread, NULL);
  if (t->pinned) (void)pthread_setaffinity_np(pthread_self(), sizeof t->before, &t->before);
  (void)pthread_cond_destroy(&t->moved);
  (void)pthread_mutex_destroy(&t->lock);
  t->share = NULL;
}
